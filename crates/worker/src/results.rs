//! `results`: prints the results in the stream, one line of JSON for each file.

use std::io::Write;
use std::time::Duration;

use async_nats::jetstream::Message;
use futures_util::StreamExt;
use lockstep2d::lockstep::RulesId;

use crate::app::Connection;
use crate::error::WorkerError;
use crate::queue::Queue;
use crate::shutdown::{Phase, Shutdown};

/// Longest time for which the server waits for results before it answers a request.
const EXPIRES: Duration = Duration::from_secs(2);

/// Maximum number of results per request.
const BATCH: usize = 500;

/// Time for which printing may continue after a signal, so that a batch is complete.
const GRACE: Duration = Duration::from_secs(1);

/// Prints the results. With `follow`, also prints later results, until a signal arrives.
pub(crate) async fn run(connection: &Connection, rules: RulesId, follow: bool) -> Result<(), WorkerError> {
    let mut shutdown = Shutdown::listen(GRACE)?;
    let (connection, mut signal) = (connection.clone(), shutdown.clone());
    // Printing runs in its own task, because it blocks while nobody reads the output.
    let printing = tokio::spawn(async move {
        tokio::select! {
            printed = print(&connection, rules, follow) => printed,
            () = signal.reached(Phase::Draining) => Ok(()),
        }
    });
    tokio::select! {
        printed = printing => printed.map_err(|error| WorkerError::Output(error.into()))?,
        () = shutdown.reached(Phase::Stopping) => Ok(()),
    }
}

async fn print(connection: &Connection, rules: RulesId, follow: bool) -> Result<(), WorkerError> {
    let queue = Queue::open(connection, rules).await?;
    let mut consumer = queue.results().await?;
    let mut left = consumer.info().await.map_err(WorkerError::nats("read the results"))?.num_pending;
    while left > 0 || follow {
        let most = if follow { BATCH } else { BATCH.min(usize::try_from(left).unwrap_or(BATCH)) };
        let batch = consumer.fetch().max_messages(most).expires(EXPIRES).messages();
        let batch = batch.await.map_err(WorkerError::nats("read the results"))?;
        // Collects the whole batch first. If a pager slowed down the reading, the client would drop messages of the
        // batch.
        let received: Vec<_> = batch.collect().await;
        let count = tokio::task::block_in_place(|| print_batch(received))?;
        left = left.saturating_sub(count);
        if count == 0 && !follow {
            // Results may have expired since they were counted. If the server is gone, this request fails.
            let info = consumer.info().await.map_err(WorkerError::nats("read the results"))?;
            left = left.min(info.num_pending);
        }
    }
    Ok(())
}

/// Prints a batch of results, and returns their number.
fn print_batch(received: Vec<Result<Message, async_nats::Error>>) -> Result<u64, WorkerError> {
    let (mut out, mut count) = (std::io::stdout().lock(), 0);
    for result in received {
        let message =
            result.map_err(|error| WorkerError::Nats { what: "read the results", why: error.to_string() })?;
        out.write_all(&message.payload).map_err(WorkerError::Output)?;
        out.write_all(b"\n").map_err(WorkerError::Output)?;
        count += 1;
    }
    out.flush().map_err(WorkerError::Output)?;
    Ok(count)
}
