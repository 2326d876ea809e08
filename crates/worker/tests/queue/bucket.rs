//! Files in a bucket of `s3s-fs`, a server with the protocol of S3 that checks signatures.

use std::process::Command;

use serde_json::Value;

use super::{replay, verified, worker, write_files};
use crate::server::{Folder, Process, Program, Server, free_port, serve, wait_until};

struct Buckets {
    port: u16,
    _process: Process,
}

impl Buckets {
    /// Serves the subfolder `in` as the bucket `uploads`. Returns `None` unless `LOCKSTEP2D_S3` is the path of
    /// `s3s-fs`.
    fn start(folder: &Folder) -> Option<Self> {
        let Ok(program) = std::env::var("LOCKSTEP2D_S3") else {
            eprintln!("skipped: LOCKSTEP2D_S3 does not name a server");
            return None;
        };
        // A bucket name needs at least three characters.
        std::os::unix::fs::symlink("in", folder.0.join("uploads")).unwrap();
        let port = free_port();
        let mut command = Command::new(program);
        command.args(["--host", "127.0.0.1", "--port", &port.to_string()]);
        command.args(["--access-key", "player", "--secret-key", "secret"]).arg(&folder.0);
        Some(Buckets { port, _process: serve(&mut command, port) })
    }

    /// The program, with this secret key of the bucket in its environment.
    fn with_key(&self, program: Program, key: &'static str) -> Program {
        let endpoint = format!("http://127.0.0.1:{}", self.port);
        let variables = [
            ("AWS_ENDPOINT", endpoint.as_str()),
            ("AWS_ALLOW_HTTP", "true"),
            ("AWS_REGION", "us-east-1"),
            ("AWS_ACCESS_KEY_ID", "player"),
            ("AWS_SECRET_ACCESS_KEY", key),
        ];
        Program { variables: variables.map(|(name, value)| (name.into(), value.into())).into(), ..program }
    }
}

#[test]
fn files_of_a_bucket_have_the_results_of_files() {
    let folder = Folder::new("bucket");
    let Some(server) = Server::start(&folder) else { return };
    let Some(buckets) = Buckets::start(&folder) else { return };
    write_files(&folder, 30);
    folder.write("in/notes.txt", b"not a replay");
    let expected = verified(&folder);
    // The worker runs in a folder without the files.
    let elsewhere = Folder::new("bucket-elsewhere");
    let program = Program { folder: elsewhere.0.clone(), ..worker(&server, &folder) };
    let program = buckets.with_key(program, "secret");

    // One file is submitted first, so it is not queued again when all files are submitted.
    let one = program.submit(&["--bucket", "s3://uploads", "00007.replay"]);
    assert_eq!(one.len(), 1, "{one:?}");
    let all = program.submit(&["--bucket", "s3://uploads/"]);
    assert_eq!(all.len(), 30);
    let known = |line: &&String| line.ends_with("\"queued\":false}");
    assert_eq!(all.iter().filter(known).count(), 1);

    let mut child = program.work(&["--bucket", "s3://uploads"]);
    wait_until("all results are there", || program.results().len() == 30);
    assert_eq!(child.terminate(), Some(0));
    // Names are relative to the bucket.
    let mut relative: Vec<String> = expected.iter().map(|line| line.replacen("\"in/", "\"", 1)).collect();
    relative.sort();
    assert_eq!(program.results(), relative);
}

#[test]
fn a_folder_of_a_bucket_holds_what_is_in_it() {
    let folder = Folder::new("bucket-folder");
    let Some(server) = Server::start(&folder) else { return };
    let Some(buckets) = Buckets::start(&folder) else { return };
    std::fs::create_dir_all(folder.0.join("in/day/night")).unwrap();
    for (number, name) in (0..).zip(["a", "day/b", "day/night/c", "day2"]) {
        folder.write(&format!("in/{name}.replay"), &replay(number, 1, 5));
    }
    let program = buckets.with_key(worker(&server, &folder), "secret");
    let names = |arguments: &[&str]| {
        let lines = program.submit(&[&["--bucket"], arguments].concat());
        let mut names: Vec<String> = lines
            .iter()
            .map(|line| serde_json::from_str::<Value>(line).unwrap()["file"].as_str().unwrap().into())
            .collect();
        names.sort();
        names
    };
    assert_eq!(names(&["s3://uploads", "day"]), ["day/b.replay", "day/night/c.replay"]);
    assert_eq!(names(&["s3://uploads/day"]), ["b.replay", "night/c.replay"]);
    assert_eq!(names(&["s3://uploads/day", "night", "b.replay"]), ["b.replay", "night/c.replay"]);
    // Files with the same bytes are one job. Its name is that of the file that was submitted first.
    let mut child = program.work(&["--bucket", "s3://uploads"]);
    wait_until("all results are there", || program.results().len() == 2);
    assert_eq!(child.terminate(), Some(0));
    for (line, name) in program.results().iter().zip(["day/b.replay", "day/night/c.replay"]) {
        let result: Value = serde_json::from_str(line).unwrap();
        assert_eq!((&result["file"], &result["verdict"]), (&name.into(), &"match".into()));
    }
}

#[test]
fn a_bucket_that_cannot_be_read_is_an_error() {
    let folder = Folder::new("bucket-error");
    let Some(server) = Server::start(&folder) else { return };
    let Some(buckets) = Buckets::start(&folder) else { return };
    folder.write("in/a.replay", &replay(1, 1, 5));
    let allowed = buckets.with_key(worker(&server, &folder), "secret");
    let forged = buckets.with_key(worker(&server, &folder), "guess");
    let cases: [(&Program, &[&str], &str); 5] = [
        (&forged, &["s3://uploads"], "SignatureDoesNotMatch"),
        (&allowed, &["s3://absent"], "cannot read the bucket s3://absent"),
        (&allowed, &["s3://uploads", "absent"], "\"absent\": nothing to submit"),
        (&allowed, &["s3://uploads", "../in/a.replay"], "cannot read the bucket"),
        (&allowed, &["ftp://in"], "cannot read the bucket ftp://in"),
    ];
    for (program, arguments, expected) in cases {
        let output = program.run(&[&["submit", "--bucket"], arguments].concat());
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
        assert!(error.contains(expected), "{arguments:?}: {error}");
    }
    // A worker without the right key reports that the file cannot be read.
    allowed.submit(&["--bucket", "s3://uploads"]);
    let mut child = forged.work(&["--bucket", "s3://uploads", "--max-deliver", "1"]);
    wait_until("there is a result", || forged.results().len() == 1);
    assert_eq!(child.terminate(), Some(0));
    let result: Value = serde_json::from_str(&forged.results()[0]).unwrap();
    assert_eq!(result["file"], "a.replay");
    assert!(result["error"].as_str().unwrap().contains("SignatureDoesNotMatch"), "{result}");
}
