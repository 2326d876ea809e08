//! [`Shutdown`]: ends a process gracefully on SIGTERM or SIGINT.

use std::time::Duration;

use tokio::sync::watch;

use crate::error::WorkerError;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Phase {
    /// The worker takes jobs.
    Running,
    /// The worker completes its file.
    Draining,
    /// The worker gives its file back to the queue.
    Stopping,
}

#[derive(Clone, Debug)]
pub(crate) struct Shutdown(watch::Receiver<Phase>);

impl Shutdown {
    /// The first signal starts `Draining`. A second signal, or the end of `grace`, starts `Stopping`.
    pub(crate) fn listen(grace: Duration) -> Result<Self, WorkerError> {
        let (phase, shutdown) = watch::channel(Phase::Running);
        let mut signals = Signals::new().map_err(|error| WorkerError::Start { what: "signals", error })?;
        tokio::spawn(async move {
            signals.next().await;
            let _ = phase.send(Phase::Draining);
            let _ = tokio::time::timeout(grace, signals.next()).await;
            let _ = phase.send(Phase::Stopping);
            phase.closed().await;
        });
        Ok(Shutdown(shutdown))
    }

    pub(crate) fn is_running(&self) -> bool {
        *self.0.borrow() == Phase::Running
    }

    pub(crate) async fn reached(&mut self, phase: Phase) {
        if self.0.wait_for(|now| *now >= phase).await.is_err() {
            // The sender is gone. The task that owns it ends only with the process, so this function waits for that
            // end.
            std::future::pending::<()>().await;
        }
    }
}

#[cfg(unix)]
struct Signals {
    terminate: tokio::signal::unix::Signal,
    interrupt: tokio::signal::unix::Signal,
}

#[cfg(unix)]
impl Signals {
    fn new() -> std::io::Result<Self> {
        use tokio::signal::unix::{SignalKind, signal};
        Ok(Signals {
            terminate: signal(SignalKind::terminate())?,
            interrupt: signal(SignalKind::interrupt())?,
        })
    }

    async fn next(&mut self) {
        tokio::select! {
            _ = self.terminate.recv() => {}
            _ = self.interrupt.recv() => {}
        }
    }
}

#[cfg(not(unix))]
struct Signals;

#[cfg(not(unix))]
impl Signals {
    fn new() -> std::io::Result<Self> {
        Ok(Signals)
    }

    async fn next(&mut self) {
        if tokio::signal::ctrl_c().await.is_err() {
            std::future::pending::<()>().await;
        }
    }
}
