//! Commands end after a signal, also while the server or the reader of the output does not answer.

use std::process::Stdio;
use std::thread;
use std::time::{Duration, Instant};

use lockstep2d::SEMANTICS;
use lockstep2d::lockstep::{Game, Sandbox};

use super::objects::with_server;
use super::{get, replay, worker};
use crate::server::{Folder, Process, Server, free_port, wait_until};

/// Waits until a process ends. Returns its exit code, and fails after `longest`.
fn end(process: &mut Process, longest: Duration) -> Option<i32> {
    let start = Instant::now();
    wait_until("the process ends", || {
        assert!(start.elapsed() < longest, "the process has not ended after {longest:?}");
        process.0.try_wait().unwrap().is_some()
    });
    process.0.wait().unwrap().code()
}

#[test]
fn results_ends_while_it_connects() {
    let folder = Folder::new("connects");
    let Some(mut server) = Server::start(&folder) else { return };
    let program = worker(&server, &folder);
    server.stop();
    let mut child = program.spawn("results", &[], Stdio::null());
    // Gives the program time to install its signal handler.
    thread::sleep(Duration::from_secs(1));
    child.signal();
    assert_eq!(end(&mut child, Duration::from_secs(5)), Some(0));
}

#[test]
fn results_ends_while_nobody_reads_its_lines() {
    let folder = Folder::new("pager");
    let Some(server) = Server::start(&folder) else { return };
    let program = worker(&server, &folder);
    // Creates the streams.
    assert!(program.results().is_empty());
    // 400 results of 1000 bytes do not fit into a pipe, which holds 64 KiB.
    with_server(&server, |context| async move {
        let name = format!("{}-{SEMANTICS}-{}", Sandbox::RULES.name, Sandbox::RULES.version);
        for number in 0..400 {
            let line = vec![b'x'; 1000];
            let sent = context.publish(format!("lockstep2d.{name}.results.{number}"), line.into()).await;
            sent.unwrap().await.unwrap();
        }
    });
    let mut child = program.spawn("results", &[], Stdio::piped());
    thread::sleep(Duration::from_secs(2));
    child.signal();
    assert_eq!(end(&mut child, Duration::from_secs(5)), Some(0));
}

#[test]
fn a_second_signal_ends_a_worker_that_cannot_add_its_result() {
    let folder = Folder::new("outage");
    let Some(mut server) = Server::start(&folder) else { return };
    let program = worker(&server, &folder);
    folder.write("in/a.replay", &replay(1, 60, 400));
    program.submit(&["in"]);
    let address = format!("127.0.0.1:{}", free_port());
    let mut child = program.work(&["--metrics", &address]);
    wait_until("the file is at work", || get(&address, "/metrics").contains("lockstep2d_worker_busy 1\n"));
    server.stop();
    wait_until("the file is done", || get(&address, "/metrics").contains("worker_ticks_total 400\n"));
    child.signal();
    thread::sleep(Duration::from_millis(500));
    child.signal();
    assert_eq!(end(&mut child, Duration::from_secs(15)), Some(0));
}

#[test]
fn a_job_that_arrives_after_the_signal_goes_back_to_the_queue() {
    let folder = Folder::new("late");
    let Some(server) = Server::start(&folder) else { return };
    let program = worker(&server, &folder);
    folder.write("in/a.replay", &replay(1, 1, 3));
    let address = format!("127.0.0.1:{}", free_port());
    let mut child = program.work(&["--metrics", &address]);
    wait_until("the worker runs", || !get(&address, "/metrics").is_empty());
    // Gives the worker time to request a job. The server holds this request for 2 s.
    thread::sleep(Duration::from_secs(1));
    child.signal();
    program.submit(&["in"]);
    assert_eq!(end(&mut child, Duration::from_secs(5)), Some(0));
    assert!(program.results().is_empty());
    // The next worker does not wait for the 30 s of `--ack-seconds`.
    let start = Instant::now();
    let mut child = program.work(&[]);
    wait_until("there is a result", || program.results().len() == 1);
    assert!(start.elapsed() < Duration::from_secs(20));
    assert_eq!(child.terminate(), Some(0));
}
