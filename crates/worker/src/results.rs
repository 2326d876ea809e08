//! `results`: prints the results in the stream, one line of JSON for each file.

use std::io::Write;
use std::time::Duration;

use futures_util::StreamExt;
use lockstep2d::lockstep::RulesId;

use crate::app::Connection;
use crate::error::WorkerError;
use crate::queue::Queue;
use crate::shutdown::Shutdown;

/// Longest time for which the server holds a request for results.
const EXPIRES: Duration = Duration::from_secs(2);

/// Maximum number of results per request.
const BATCH: usize = 500;

/// Prints the results. With `follow`, also prints later results, until a signal.
pub(crate) async fn run(connection: &Connection, rules: RulesId, follow: bool) -> Result<(), WorkerError> {
    let shutdown = Shutdown::listen(Duration::ZERO)?;
    let queue = Queue::open(connection, rules).await?;
    let mut consumer = queue.results().await?;
    let mut left = consumer.info().await.map_err(WorkerError::nats("read the results"))?.num_pending;
    let mut out = std::io::stdout().lock();
    while left > 0 || (follow && shutdown.is_running()) {
        let most = if follow { BATCH } else { BATCH.min(usize::try_from(left).unwrap_or(BATCH)) };
        let batch = consumer.fetch().max_messages(most).expires(EXPIRES).messages();
        let batch = batch.await.map_err(WorkerError::nats("read the results"))?;
        // Collects the whole batch first. If a pager slowed down the reading of a batch, the client would drop messages
        // of it.
        let received: Vec<_> = batch.collect().await;
        let before = left;
        for result in received {
            let message = result
                .map_err(|error| WorkerError::Nats { what: "read the results", why: error.to_string() })?;
            out.write_all(&message.payload).map_err(WorkerError::Output)?;
            out.write_all(b"\n").map_err(WorkerError::Output)?;
            left = left.saturating_sub(1);
        }
        out.flush().map_err(WorkerError::Output)?;
        if left == before && !follow {
            // Results may have expired since they were counted. If the server is gone, this request fails.
            let info = consumer.info().await.map_err(WorkerError::nats("read the results"))?;
            left = left.min(info.num_pending);
        }
    }
    Ok(())
}
