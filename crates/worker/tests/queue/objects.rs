//! Files in the object store: deleted files, and files whose content is missing, so that reading them hangs.

use std::process::Command;
use std::thread;
use std::time::Duration;

use async_nats::jetstream::{self, Context};
use lockstep2d::SEMANTICS;
use lockstep2d::lockstep::{Game, Sandbox};
use serde_json::Value;

use super::{get, replay, worker};
use crate::server::{Folder, Server, free_port, wait_until};

/// Name of the object store of the default queue.
fn bucket() -> String {
    format!("{}-{SEMANTICS}-{}_files", Sandbox::RULES.name, Sandbox::RULES.version)
}

pub(crate) fn with_server<F: Future>(server: &Server, act: impl FnOnce(Context) -> F) -> F::Output {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    runtime.block_on(async { act(jetstream::new(async_nats::connect(server.url()).await.unwrap())).await })
}

#[test]
fn a_deleted_object_is_stored_again() {
    let folder = Folder::new("deleted");
    let Some(server) = Server::start(&folder) else { return };
    let program = worker(&server, &folder);
    let bytes = replay(1, 1, 3);
    folder.write("in/a.replay", &bytes);
    program.submit(&["--objects", "in"]);
    with_server(&server, |context| async move {
        let store = context.get_object_store(bucket()).await.unwrap();
        store.delete(blake3::hash(&bytes).to_string()).await.unwrap();
    });
    program.submit(&["--objects", "in"]);
    let mut child = program.work(&["--max-deliver", "1"]);
    wait_until("there is a result", || program.results().len() == 1);
    assert_eq!(child.terminate(), Some(0));
    let result: Value = serde_json::from_str(&program.results()[0]).unwrap();
    assert_eq!(result["verdict"], "match", "{result}");
}

/// `submit` opens the file twice. The pipe returns other bytes the second time, like a file that is still being
/// written.
#[test]
fn a_file_that_changes_while_it_is_submitted_is_an_error() {
    let folder = Folder::new("changes");
    let Some(server) = Server::start(&folder) else { return };
    let program = worker(&server, &folder);
    let pipe = folder.0.join("in/a.replay");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let writer = thread::spawn(move || {
        for number in 1..3 {
            std::fs::write(&pipe, replay(number, 1, 3)).unwrap();
            // Gives the reader time to close the pipe before it is written again.
            thread::sleep(Duration::from_secs(1));
        }
    });
    let output = program.run(&["submit", "--objects", "in/a.replay"]);
    writer.join().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("the file has changed"));
}

#[test]
fn a_worker_ends_while_reading_hangs_and_a_file_that_hangs_has_a_result() {
    let folder = Folder::new("hangs");
    let Some(server) = Server::start(&folder) else { return };
    let program = worker(&server, &folder);
    folder.write("in/a.replay", &replay(1, 1, 3));
    program.submit(&["--objects", "in"]);
    with_server(&server, |context| async move {
        let stream = context.get_stream(format!("OBJ_{}", bucket())).await.unwrap();
        let purged = stream.purge().filter(format!("$O.{}.C.>", bucket())).await.unwrap();
        assert_eq!(purged.purged, 1);
    });

    let address = format!("127.0.0.1:{}", free_port());
    let mut child = program.work(&["--grace-seconds", "1", "--metrics", &address]);
    wait_until("the worker reads", || get(&address, "/metrics").contains("lockstep2d_worker_busy 1\n"));
    child.signal();
    wait_until("the worker ends", || child.0.try_wait().unwrap().is_some());
    assert_eq!(child.0.wait().unwrap().code(), Some(0));

    // The job is back in the queue. The next delivery is the last one.
    let mut child = program.work(&["--read-seconds", "1", "--max-deliver", "2"]);
    wait_until("there is a result", || program.results().len() == 1);
    assert_eq!(child.terminate(), Some(0));
    let result: Value = serde_json::from_str(&program.results()[0]).unwrap();
    assert_eq!(result["error"], "the file was not read within 1 s", "{result}");
}
