//! `work`: takes jobs from the queue and adds their results.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use async_nats::jetstream::consumer::PullConsumer;
use async_nats::jetstream::object_store::ObjectStore;
use async_nats::jetstream::{AckKind, Message};
use futures_util::StreamExt;
use lockstep2d::lockstep::Game;
use lockstep2d::replay::Limits;
use lockstep2d_cli::{Judge, Judged};
use serde::Serialize;
use tokio::net::TcpListener;

use crate::app::WorkArguments;
use crate::bucket::Bucket;
use crate::error::WorkerError;
use crate::files;
use crate::job::{Job, Source};
use crate::metrics::Metrics;
use crate::queue::{Added, Queue, json};
use crate::shutdown::{Phase, Shutdown};

/// Longest time for which the server waits for a job before it answers a request. After a signal, an idle worker ends
/// within this time.
const EXPIRES: Duration = Duration::from_secs(2);

/// A request that is not answered within this time after [`EXPIRES`] counts as lost. The time is shorter than the
/// timeout of the NATS client, because after its timeout the client reports a lost request as if the queue were empty.
const LOST: Duration = Duration::from_secs(4);

/// If all requests have failed for this time, the worker ends.
const OUTAGE_MAX: Duration = Duration::from_secs(60);

/// Pause before another attempt to read a file. It is multiplied by the number of deliveries so far.
const READ_AGAIN: Duration = Duration::from_secs(1);

/// Verdict on a file that was delivered as often as `--max-deliver` allows, each time without a result.
const CRASHED: &str = "crashed";
/// Label, in the metrics, of results for files that could not be read.
const UNREAD: &str = "unread";

struct Work<G: Game + 'static> {
    queue: Queue,
    judge: Arc<Judge<G>>,
    folder: PathBuf,
    store: ObjectStore,
    bucket: Option<Bucket>,
    max_deliver: u64,
    /// Longest time to read a file.
    read_max: Duration,
    /// Interval between progress messages to the server.
    progress: Duration,
    metrics: Arc<Metrics>,
}

enum Done {
    Result(Judged),
    /// Return the job to the queue, for another delivery after this pause.
    Again(Duration),
}

pub(crate) async fn run<G: Game + 'static>(
    arguments: &WorkArguments,
    limits: &Limits,
) -> Result<(), WorkerError> {
    let mut shutdown = Shutdown::listen(arguments.grace_seconds)?;
    let judge = Arc::new(Judge::<G>::new(arguments.limits.over(limits)));
    let bucket = arguments.bucket.as_ref().map(Bucket::open).transpose()?;
    let metrics = Arc::new(Metrics::default());
    if let Some(address) = arguments.metrics {
        let failed = |error| WorkerError::Start { what: "the metrics", error };
        let listener = TcpListener::bind(address).await.map_err(failed)?;
        let of_ticks = Arc::clone(&judge);
        tokio::spawn(Arc::clone(&metrics).serve(listener, move || of_ticks.ticks()));
    }
    let start = async {
        let queue = Queue::open(&arguments.connection, G::RULES).await?;
        let (jobs, store) = (queue.jobs(arguments.ack_seconds).await?, queue.files().await?);
        Ok::<_, WorkerError>((queue, jobs, store))
    };
    let (queue, jobs, store) = tokio::select! {
        started = start => started?,
        () = shutdown.reached(Phase::Draining) => return Ok(()),
    };
    let work = Work {
        queue,
        judge,
        folder: arguments.folder.clone(),
        store,
        bucket,
        max_deliver: arguments.max_deliver.into(),
        read_max: arguments.read_seconds,
        progress: arguments.ack_seconds / 3,
        metrics,
    };
    let mut outage = Outage::default();
    while shutdown.is_running() {
        let message = next(&jobs).await;
        let is_over = outage.exceeds(message.is_err(), Instant::now());
        let message = message.or_else(|error| if is_over { Err(error) } else { Ok(None) })?;
        let Some(message) = message else { continue };
        if !shutdown.is_running() {
            // The signal arrived during the request.
            give_back(&message).await;
            break;
        }
        work.metrics.is_busy.store(true, Ordering::Relaxed);
        tokio::select! {
            taken = work.take(&message) => taken?,
            () = shutdown.reached(Phase::Stopping) => {
                work.judge.stop();
                give_back(&message).await;
            }
        }
        work.metrics.is_busy.store(false, Ordering::Relaxed);
    }
    Ok(())
}

/// The next job. `None` if none arrives in time.
async fn next(jobs: &PullConsumer) -> Result<Option<Message>, WorkerError> {
    let failed = |why: String| WorkerError::Nats { what: "take a job", why };
    let request = async {
        let mut batch = jobs.fetch().max_messages(1).expires(EXPIRES).messages().await?;
        batch.next().await.transpose()
    };
    let result = match tokio::time::timeout(EXPIRES + LOST, request).await {
        Ok(answer) => answer.map_err(|error: async_nats::Error| failed(error.to_string())),
        Err(_) => Err(failed("the server does not answer".into())),
    };
    if result.is_err() {
        // Some errors return at once, so a pause limits the rate of requests.
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
    result
}

/// The time of the first request that failed, if no request has succeeded since.
#[derive(Default)]
struct Outage(Option<Instant>);

impl Outage {
    /// Records the outcome of a request. Returns whether requests have failed for [`OUTAGE_MAX`].
    fn exceeds(&mut self, has_failed: bool, now: Instant) -> bool {
        if !has_failed {
            self.0 = None;
            return false;
        }
        now.duration_since(*self.0.get_or_insert(now)) >= OUTAGE_MAX
    }
}

impl<G: Game + 'static> Work<G> {
    async fn take(&self, message: &Message) -> Result<(), WorkerError> {
        let job = serde_json::from_slice::<Job>(&message.payload).ok();
        let Some((job, digest)) = job.and_then(|job| job.digest().map(|digest| (job, digest))) else {
            eprintln!("warning: a message in the queue is not a job; it is dropped");
            acknowledge(message, AckKind::Term).await;
            return Ok(());
        };
        let delivered = message.info().map_or(1, |info| u64::try_from(info.delivered).unwrap_or(1));
        if delivered > 1 {
            self.metrics.redelivered.fetch_add(1, Ordering::Relaxed);
        }
        let key = self.judge.key(&digest);
        if self.queue.has_result(&key).await? {
            self.metrics.known.fetch_add(1, Ordering::Relaxed);
            acknowledge(message, AckKind::Ack).await;
            return Ok(());
        }
        match self.done(message, &job, digest, delivered).await {
            Done::Again(pause) => acknowledge(message, AckKind::Nak(Some(pause))).await,
            Done::Result(Judged { verdict, line }) => {
                // The job leaves the queue only after its result has been stored.
                match self.queue.add_result(&key, &line).await? {
                    Added::New => self.metrics.add_result(&verdict),
                    Added::Known => drop(self.metrics.known.fetch_add(1, Ordering::Relaxed)),
                }
                acknowledge(message, AckKind::Ack).await;
            }
        }
        Ok(())
    }

    /// Verifies the file of a job. In the meantime, tells the server that work continues.
    async fn done(&self, message: &Message, job: &Job, digest: [u8; 32], delivered: u64) -> Done {
        if delivered > self.max_deliver {
            return Done::Result(crashed(job, self.max_deliver));
        }
        let verify = self.verify(job, digest, delivered);
        tokio::pin!(verify);
        loop {
            tokio::select! {
                done = &mut verify => return done,
                () = tokio::time::sleep(self.progress) => {
                    // If this message is lost, another worker may verify the file as well. The server then accepts only
                    // the first result.
                    let _ = message.ack_with(AckKind::Progress).await;
                }
            }
        }
    }

    async fn verify(&self, job: &Job, digest: [u8; 32], delivered: u64) -> Done {
        let read = tokio::time::timeout(self.read_max, self.read(job)).await;
        let bytes = match read.unwrap_or_else(|_| Err(self.too_slow())) {
            Ok(bytes) => bytes,
            Err(error) if delivered >= self.max_deliver => return Done::Result(unread(job, &error)),
            Err(_) => return Done::Again(READ_AGAIN * u32::try_from(delivered).unwrap_or(u32::MAX)),
        };
        let (judge, file) = (Arc::clone(&self.judge), job.file.clone());
        // The result contains the digest of the whole file, by which users match results with files. The digest is
        // taken from the job, because only the beginning of a large file has been read.
        let judged = tokio::task::spawn_blocking(move || judge.judge_part(&file, &bytes, &digest)).await;
        judged.ok().flatten().map_or(Done::Again(Duration::ZERO), Done::Result)
    }

    fn too_slow(&self) -> io::Error {
        io::Error::other(format!("the file was not read within {} s", self.read_max.as_secs()))
    }

    async fn read(&self, job: &Job) -> io::Result<Vec<u8>> {
        let bytes_max = self.judge.limits().file_bytes;
        let bytes = match job.source {
            Source::Object => files::read_object(&self.store, &job.blake3, bytes_max).await?,
            Source::Bucket => {
                let bucket = self.bucket.as_ref().ok_or(io::Error::other("the worker has no --bucket"))?;
                bucket.read(&job.file, bytes_max).await.map_err(io::Error::other)?
            }
            Source::Folder => {
                let (folder, file) = (self.folder.clone(), job.file.clone());
                let read = move || files::read_path(&folder, &file, bytes_max);
                tokio::task::spawn_blocking(read).await.map_err(io::Error::other)??
            }
        };
        files::check(job, bytes, bytes_max)
    }
}

/// Returns a job to the queue at once.
async fn give_back(message: &Message) {
    acknowledge(message, AckKind::Nak(Some(Duration::ZERO))).await;
}

/// Acknowledges a message, and waits up to 5 s for the server's confirmation. If the acknowledgement is lost, the job
/// is delivered again. The worker that gets it finds that the result exists, and drops the job.
async fn acknowledge(message: &Message, kind: AckKind) {
    let _ = message.double_ack_with(kind).await;
}

/// Result for a job that has been delivered too often. The file is not read.
fn crashed(job: &Job, deliveries: u64) -> Judged {
    #[derive(Serialize)]
    struct Line<'a> {
        file: &'a str,
        verdict: &'static str,
        deliveries: u64,
        blake3: &'a str,
        cached: bool,
    }
    let line = Line { file: &job.file, verdict: CRASHED, deliveries, blake3: &job.blake3, cached: false };
    Judged { verdict: CRASHED.into(), line: json(&line) }
}

fn unread(job: &Job, error: &io::Error) -> Judged {
    #[derive(Serialize)]
    struct Line<'a> {
        file: &'a str,
        error: String,
        blake3: &'a str,
    }
    let line = Line { file: &job.file, error: error.to_string(), blake3: &job.blake3 };
    Judged { verdict: UNREAD.into(), line: json(&line) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_worker_ends_after_a_minute_of_errors() {
        let start = Instant::now();
        let at = |seconds| start + Duration::from_secs(seconds);
        let mut outage = Outage::default();
        assert!(!outage.exceeds(true, at(0)) && !outage.exceeds(true, at(59)));
        assert!(!outage.exceeds(false, at(60)), "a server that has no job is there");
        assert!(!outage.exceeds(true, at(61)) && !outage.exceeds(true, at(120)));
        assert!(outage.exceeds(true, at(121)));
    }
}
