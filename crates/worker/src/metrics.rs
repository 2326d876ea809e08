//! [`Metrics`]: counters in the text format of Prometheus, over plain HTTP.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};

/// Longest time for a request and its answer.
const REQUEST_MAX: Duration = Duration::from_secs(5);

#[derive(Debug, Default)]
pub(crate) struct Metrics {
    /// Number of added results, by verdict.
    results: Mutex<BTreeMap<String, u64>>,
    /// Number of jobs that already had a result.
    pub(crate) known: AtomicU64,
    /// Number of jobs that had been delivered before.
    pub(crate) redelivered: AtomicU64,
    /// Whether a file is being verified.
    pub(crate) is_busy: AtomicBool,
}

impl Metrics {
    pub(crate) fn add_result(&self, verdict: &str) {
        let mut results = self.results.lock().unwrap_or_else(PoisonError::into_inner);
        *results.entry(verdict.into()).or_default() += 1;
    }

    /// The text of all metrics. `ticks` is the number of simulated ticks.
    fn text(&self, ticks: u64) -> String {
        let mut text = String::from("# TYPE lockstep2d_worker_results_total counter\n");
        for (verdict, count) in self.results.lock().unwrap_or_else(PoisonError::into_inner).iter() {
            let _ = writeln!(text, "lockstep2d_worker_results_total{{verdict=\"{verdict}\"}} {count}");
        }
        let counters = [
            ("known_total", "counter", self.known.load(Ordering::Relaxed)),
            ("redelivered_total", "counter", self.redelivered.load(Ordering::Relaxed)),
            ("ticks_total", "counter", ticks),
            ("busy", "gauge", self.is_busy.load(Ordering::Relaxed).into()),
        ];
        for (name, kind, value) in counters {
            let _ =
                writeln!(text, "# TYPE lockstep2d_worker_{name} {kind}\nlockstep2d_worker_{name} {value}");
        }
        text
    }

    /// Answers requests, one at a time.
    pub(crate) async fn serve(self: Arc<Self>, listener: TcpListener, ticks: impl Fn() -> u64) {
        loop {
            let Ok((stream, _)) = listener.accept().await else {
                // The error may be temporary, such as too many open files.
                tokio::time::sleep(Duration::from_millis(100)).await;
                continue;
            };
            let _ = tokio::time::timeout(REQUEST_MAX, answer(stream, self.text(ticks()))).await;
        }
    }
}

async fn answer(mut stream: TcpStream, text: String) -> std::io::Result<()> {
    let (mut request, mut length) = ([0; 1024], 0);
    while !request[..length].contains(&b'\n') && length < request.len() {
        match stream.read(&mut request[length..]).await? {
            0 => break,
            count => length += count,
        }
    }
    let is_found = request[..length].starts_with(b"GET /metrics ");
    let (status, body) = if is_found { ("200 OK", text) } else { ("404 Not Found", String::new()) };
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: text/plain; version=0.0.4\r\nContent-Length: {}\r\n\
         Connection: close\r\n\r\n",
        body.len()
    );
    stream.write_all(head.as_bytes()).await?;
    stream.write_all(body.as_bytes()).await?;
    stream.shutdown().await
}
