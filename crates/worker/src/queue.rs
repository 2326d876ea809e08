//! [`Queue`]: jobs, results and files in JetStream.

use std::future::Future;
use std::time::Duration;

use async_nats::ConnectOptions;
use async_nats::jetstream::consumer::{AckPolicy, PullConsumer, pull};
use async_nats::jetstream::context::PublishErrorKind;
use async_nats::jetstream::message::PublishMessage;
use async_nats::jetstream::object_store::{self, ObjectStore};
use async_nats::jetstream::stream::{self, LastRawMessageErrorKind, RetentionPolicy, Stream};
use async_nats::jetstream::{self, Context};
use lockstep2d::SEMANTICS;
use lockstep2d::lockstep::RulesId;

use crate::app::Connection;
use crate::error::WorkerError;
use crate::job::Job;

/// Time for which a submitted job is remembered. If it is submitted again within this time, it counts as a duplicate.
const DUPLICATE_WINDOW: Duration = Duration::from_secs(3600);

/// Name of the consumer that all workers share.
const CONSUMER: &str = "workers";

/// Time without requests after which the server deletes the consumer of a `results` command. It is long, because the
/// command sends no requests while a pager holds up its output.
const RESULTS_KEPT: Duration = Duration::from_secs(10 * 60);

/// Pauses between attempts. They last about a minute in total, which is enough for a restart of the server.
const PAUSES: [Duration; 8] = [
    Duration::from_millis(100),
    Duration::from_millis(400),
    Duration::from_secs(1),
    Duration::from_secs(3),
    Duration::from_secs(6),
    Duration::from_secs(10),
    Duration::from_secs(20),
    Duration::from_secs(20),
];

#[derive(Clone, Debug)]
pub(crate) struct Queue {
    context: Context,
    name: String,
    results: Stream,
    replicas: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Added {
    New,
    Known,
}

/// Default name of the queue: the name of the rules, the semantics id and the version of the rules. Programs of
/// different versions therefore do not share jobs.
pub(crate) fn default_name(rules: RulesId) -> String {
    let name: String =
        rules.name.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' }).collect();
    format!("{name}-{SEMANTICS}-{}", rules.version)
}

impl Queue {
    /// Connects, and creates missing streams.
    pub(crate) async fn open(connection: &Connection, rules: RulesId) -> Result<Self, WorkerError> {
        let options = match &connection.credentials {
            Some(path) => {
                ConnectOptions::with_credentials_file(path).await.map_err(WorkerError::read(path))?
            }
            None => ConnectOptions::new(),
        };
        let options = options.name("lockstep2d-worker");
        let connect = || options.clone().connect(connection.nats.as_str());
        let client = retry("connect to NATS", connect).await?;
        let context = jetstream::new(client);
        let name = connection.queue.clone().unwrap_or_else(|| default_name(rules));
        let replicas = usize::from(connection.replicas);
        let jobs = stream::Config {
            name: format!("{name}_jobs"),
            subjects: vec![jobs_subject(&name)],
            retention: RetentionPolicy::WorkQueue,
            duplicate_window: DUPLICATE_WINDOW,
            num_replicas: replicas,
            ..Default::default()
        };
        let results = stream::Config {
            name: format!("{name}_results"),
            subjects: vec![results_subject(&name, "*")],
            num_replicas: replicas,
            ..Default::default()
        };
        retry("open the stream of jobs", || context.get_or_create_stream(jobs.clone())).await?;
        let open = || context.get_or_create_stream(results.clone());
        let results = retry("open the stream of results", open).await?;
        Ok(Queue { context, name, results, replicas })
    }

    /// Adds a job, unless a job for the same bytes was added within the last hour.
    pub(crate) async fn submit(&self, job: &Job) -> Result<Added, WorkerError> {
        let payload = json(job);
        let publish = || async {
            let message =
                PublishMessage::build().message_id(&job.blake3).payload(payload.clone().into_bytes().into());
            self.context.send_publish(jobs_subject(&self.name), message).await?.await
        };
        let ack = retry("submit a job", publish).await?;
        Ok(if ack.duplicate { Added::Known } else { Added::New })
    }

    /// The consumer of all workers. A job that is not acknowledged within `ack_wait` is delivered again.
    pub(crate) async fn jobs(&self, ack_wait: Duration) -> Result<PullConsumer, WorkerError> {
        let config = pull::Config {
            durable_name: Some(CONSUMER.into()),
            ack_policy: AckPolicy::Explicit,
            ack_wait,
            // No limit: workers count the deliveries instead, so that a file that crashes workers gets a result, too.
            max_deliver: -1,
            // No limit: each worker has at most one unacknowledged job.
            max_ack_pending: -1,
            ..Default::default()
        };
        let stream = format!("{}_jobs", self.name);
        let open = || self.context.create_consumer_on_stream(config.clone(), stream.clone());
        retry("open the queue of jobs", open).await
    }

    pub(crate) async fn has_result(&self, key: &str) -> Result<bool, WorkerError> {
        let subject = results_subject(&self.name, key);
        let look = || async {
            match self.results.get_last_raw_message_by_subject(&subject).await {
                Ok(_) => Ok(true),
                Err(error) if matches!(error.kind(), LastRawMessageErrorKind::NoMessageFound) => Ok(false),
                Err(error) => Err(error),
            }
        };
        retry("look up a result", look).await
    }

    /// Adds a result, unless a result with this key exists.
    pub(crate) async fn add_result(&self, key: &str, line: &str) -> Result<Added, WorkerError> {
        let publish = || async {
            let message = PublishMessage::build()
                .expected_last_subject_sequence(0)
                .payload(line.to_string().into_bytes().into());
            let sent = self.context.send_publish(results_subject(&self.name, key), message).await?;
            match sent.await {
                Ok(_) => Ok(Added::New),
                // Another worker has already added the result, or an earlier attempt succeeded and its answer was lost.
                Err(error) if error.kind() == PublishErrorKind::WrongLastSequence => Ok(Added::Known),
                Err(error) => Err(error),
            }
        };
        retry("add a result", publish).await
    }

    /// A consumer of all results, starting with the first.
    pub(crate) async fn results(&self) -> Result<PullConsumer, WorkerError> {
        let inactive_threshold = RESULTS_KEPT;
        let config = pull::Config { ack_policy: AckPolicy::None, inactive_threshold, ..Default::default() };
        retry("read the results", || self.results.create_consumer(config.clone())).await
    }

    pub(crate) async fn files(&self) -> Result<ObjectStore, WorkerError> {
        let bucket = format!("{}_files", self.name);
        let config = object_store::Config {
            bucket: bucket.clone(),
            num_replicas: self.replicas,
            ..Default::default()
        };
        let open = || async {
            match self.context.get_object_store(&bucket).await {
                Ok(store) => Ok(store),
                Err(_) => self.context.create_object_store(config.clone()).await,
            }
        };
        retry("open the object store", open).await
    }
}

fn jobs_subject(name: &str) -> String {
    format!("lockstep2d.{name}.jobs")
}

fn results_subject(name: &str, key: &str) -> String {
    format!("lockstep2d.{name}.results.{key}")
}

pub(crate) fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).expect("strings and numbers have a JSON form")
}

/// Repeats a failing operation for about a minute. If all attempts fail, returns the last error.
pub(crate) async fn retry<T, E, F>(
    what: &'static str,
    mut attempt: impl FnMut() -> F,
) -> Result<T, WorkerError>
where
    E: std::error::Error,
    F: Future<Output = Result<T, E>>,
{
    for pause in PAUSES {
        match attempt().await {
            Ok(value) => return Ok(value),
            Err(_) => tokio::time::sleep(pause).await,
        }
    }
    attempt().await.map_err(WorkerError::nats(what))
}
