//! [`Worker`]: the commands of a worker, and their dispatch.

use std::marker::PhantomData;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use lockstep2d::lockstep::Game;
use lockstep2d::replay::Limits;
use lockstep2d_cli::{LimitArguments, with_defaults};
use url::Url;

use crate::error::WorkerError;
use crate::{results, submit, work};

/// Stack size of the runtime's threads in bytes: that of a usual main thread, so that games may rely on it.
const STACK_BYTES: usize = 8 << 20;

/// Exit code for an error.
const TROUBLE: u8 = 2;

/// The worker of a game.
///
/// ```no_run
/// use lockstep2d::lockstep::Sandbox;
/// use lockstep2d::replay::Limits;
/// use lockstep2d_worker::Worker;
///
/// fn main() -> std::process::ExitCode {
///     Worker::<Sandbox>::new().with_limits(Limits { ticks: 36_000, ..Limits::default() }).run()
/// }
/// ```
pub struct Worker<G: Game + 'static> {
    limits: Limits,
    game: PhantomData<fn() -> G>,
}

impl<G: Game + 'static> Default for Worker<G> {
    fn default() -> Self {
        Self::new()
    }
}

impl<G: Game + 'static> Worker<G> {
    /// A worker with the default limits.
    #[must_use]
    pub fn new() -> Self {
        Worker { limits: Limits::default(), game: PhantomData }
    }

    /// Sets the limits of a replay. Command-line arguments override them.
    #[must_use]
    pub fn with_limits(self, limits: Limits) -> Self {
        Worker { limits, ..self }
    }

    /// Runs the command that the arguments of this process select. The exit code is 0 for success, and 2 for wrong
    /// usage or an error.
    #[must_use]
    pub fn run(&self) -> ExitCode {
        match self.start() {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => {
                eprintln!("error: {error}");
                TROUBLE.into()
            }
        }
    }

    fn start(&self) -> Result<(), WorkerError> {
        let rules = G::RULES;
        let (engine, semantics) = (lockstep2d::VERSION, lockstep2d::SEMANTICS);
        let command = Arguments::command()
            .version(format!("rules version {}, engine {engine}, semantics {semantics}", rules.version))
            .about(format!(
                "Verify replays of {} on many machines, with a queue in NATS JetStream",
                rules.name
            ))
            .mut_subcommand("work", |work| with_defaults(work, &self.limits));
        let arguments =
            Arguments::from_arg_matches(&command.get_matches()).unwrap_or_else(|usage| usage.exit());
        // Installs a TLS provider. This fails if the program has already installed one.
        let _ = rustls::crypto::ring::default_provider().install_default();
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .thread_stack_size(STACK_BYTES)
            .enable_all()
            .build()
            .map_err(|error| WorkerError::Start { what: "the runtime", error })?;
        let result = runtime.block_on(async {
            match &arguments.command {
                Command::Work(arguments) => work::run::<G>(arguments, &self.limits).await,
                Command::Submit(arguments) => submit::run(arguments, rules).await,
                Command::Results { connection, follow } => results::run(connection, rules, *follow).await,
            }
        });
        // Does not wait for other threads, because a hanging file system must not delay the end of the process.
        runtime.shutdown_background();
        result
    }
}

#[derive(Parser, Debug)]
#[command(
    after_help = "Exit code: 0 for success and after a signal, 2 for wrong usage, or when NATS or a file cannot \
                        be reached for a minute. See docs/WORKERS.md."
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand, Debug)]
enum Command {
    /// Take jobs from the queue, one at a time, and add their results
    Work(WorkArguments),
    /// Add files to the queue, and print a line of JSON for each
    Submit(SubmitArguments),
    /// Print the results: the lines of `verify --json`
    Results {
        #[command(flatten)]
        connection: Connection,
        /// Also print later results, until a signal
        #[arg(long)]
        follow: bool,
    },
}

/// Connection to the queue.
#[derive(Args, Clone, Debug)]
pub(crate) struct Connection {
    /// The server: nats://host:4222, or tls://host
    #[arg(long, env = "NATS_URL", hide_env_values = true, value_name = "URL")]
    pub(crate) nats: String,
    /// File with the credentials of the user
    #[arg(long, value_name = "FILE")]
    pub(crate) credentials: Option<PathBuf>,
    /// Name of the queue: letters, digits, - and _ [default: rules, semantics and version of the rules]
    #[arg(long, value_name = "NAME", value_parser = queue_name)]
    pub(crate) queue: Option<String>,
    /// Copies of each message in a cluster, for streams that do not exist yet
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=5))]
    pub(crate) replicas: u8,
}

/// Arguments of `submit`.
#[derive(Args, Clone, Debug)]
pub(crate) struct SubmitArguments {
    #[command(flatten)]
    pub(crate) connection: Connection,
    /// Store the files in the object store of the queue; otherwise workers read them from their folder
    #[arg(long)]
    pub(crate) objects: bool,
    /// Submit the files of a bucket, or of a folder in it: s3://bucket/folder. PATHs are relative to it
    #[arg(long, value_name = "URL", conflicts_with = "objects")]
    pub(crate) bucket: Option<Url>,
    /// Replays, and folders that contain *.replay files at any depth
    #[arg(required_unless_present = "bucket", value_name = "PATH")]
    pub(crate) paths: Vec<PathBuf>,
}

/// Arguments of `work`.
#[derive(Args, Clone, Debug)]
pub(crate) struct WorkArguments {
    #[command(flatten)]
    pub(crate) connection: Connection,
    /// Folder that the paths of jobs are relative to
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub(crate) folder: PathBuf,
    /// Bucket, or folder in it, with the files of `submit --bucket`: s3://bucket/folder. AWS_* variables have the
    /// credentials, the region and the endpoint
    #[arg(long, value_name = "URL")]
    pub(crate) bucket: Option<Url>,
    /// Number of deliveries of a job without a result after which its result is `crashed`
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) max_deliver: u16,
    /// Seconds without a sign of progress after which a job goes to another worker
    #[arg(long, value_name = "N", default_value = "30", value_parser = seconds)]
    pub(crate) ack_seconds: Duration,
    /// Seconds after which reading a file has failed; it is tried again in another delivery
    #[arg(long, value_name = "N", default_value = "300", value_parser = seconds)]
    pub(crate) read_seconds: Duration,
    /// Seconds after a signal in which the file at work may be completed; then, or after a second signal, it goes back
    /// to the queue
    #[arg(long, value_name = "N", default_value = "20", value_parser = seconds)]
    pub(crate) grace_seconds: Duration,
    /// Address to serve /metrics on, such as 127.0.0.1:9100
    #[arg(long, value_name = "ADDRESS")]
    pub(crate) metrics: Option<SocketAddr>,
    #[command(flatten)]
    pub(crate) limits: LimitArguments,
}

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().map_err(|_| "not a number".to_string())?;
    if seconds == 0 { Err("at least 1".into()) } else { Ok(Duration::from_secs(seconds)) }
}

fn queue_name(text: &str) -> Result<String, String> {
    let is_allowed = |letter: u8| letter.is_ascii_alphanumeric() || letter == b'-' || letter == b'_';
    let is_name = !text.is_empty() && text.len() <= 64 && text.bytes().all(is_allowed);
    if is_name { Ok(text.into()) } else { Err("1 to 64 letters, digits, - and _".into()) }
}
