//! A NATS server and processes for the tests.

use std::fs;
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for an expected event.
pub(crate) const PATIENCE: Duration = Duration::from_secs(300);

/// Commands that start the server. The second is its path in Debian, because `/usr/sbin` is not in every search path.
const PROGRAMS: [&str; 2] = ["nats-server", "/usr/sbin/nats-server"];

/// Process that is killed on drop.
pub(crate) struct Process(pub(crate) Child);

impl Drop for Process {
    fn drop(&mut self) {
        self.kill();
    }
}

impl Process {
    pub(crate) fn kill(&mut self) {
        let _ = self.0.kill();
        self.0.wait().unwrap();
    }

    /// Sends SIGTERM.
    pub(crate) fn signal(&self) {
        assert!(Command::new("kill").arg(self.0.id().to_string()).status().unwrap().success());
    }

    /// Ends the process by SIGTERM, and returns its exit code.
    pub(crate) fn terminate(&mut self) -> Option<i32> {
        self.signal();
        self.0.wait().unwrap().code()
    }
}

/// A server on a port that no other server uses.
pub(crate) struct Server {
    program: &'static str,
    port: u16,
    store: PathBuf,
    process: Process,
}

impl Server {
    /// Starts a server. Returns `None` if it is not installed. With `LOCKSTEP2D_NATS=required`, this is an error.
    pub(crate) fn start(folder: &Folder) -> Option<Self> {
        let is_there = |program: &&&str| Command::new(program).arg("--version").output().is_ok();
        let Some(program) = PROGRAMS.iter().find(is_there) else {
            let is_required = std::env::var("LOCKSTEP2D_NATS").is_ok_and(|value| value == "required");
            assert!(!is_required, "expected nats-server to be installed");
            eprintln!("skipped: nats-server is not installed");
            return None;
        };
        let port = free_port();
        let store = folder.0.join("nats");
        let process = spawn(program, port, &store);
        Some(Server { program, port, store, process })
    }

    /// Kills the server and starts it again.
    pub(crate) fn restart(&mut self) {
        self.process.kill();
        self.process = spawn(self.program, self.port, &self.store);
    }

    pub(crate) fn stop(&mut self) {
        self.process.kill();
    }

    pub(crate) fn url(&self) -> String {
        format!("nats://127.0.0.1:{}", self.port)
    }
}

fn spawn(program: &str, port: u16, store: &Path) -> Process {
    let port_text = port.to_string();
    let mut command = Command::new(program);
    command.args(["--addr", "127.0.0.1", "--port", &port_text, "--jetstream", "--store_dir"]).arg(store);
    serve(&mut command, port)
}

/// Waits until the server listens.
pub(crate) fn serve(command: &mut Command, port: u16) -> Process {
    let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    wait_until("the server listens", || TcpStream::connect(("127.0.0.1", port)).is_ok());
    Process(child)
}

pub(crate) fn free_port() -> u16 {
    TcpListener::bind(("127.0.0.1", 0)).unwrap().local_addr().unwrap().port()
}

pub(crate) fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < PATIENCE, "waited too long until {what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A worker, or another program with the same commands.
pub(crate) struct Program {
    pub(crate) path: PathBuf,
    pub(crate) url: String,
    pub(crate) folder: PathBuf,
    pub(crate) variables: Vec<(String, String)>,
}

impl Program {
    pub(crate) fn run(&self, arguments: &[&str]) -> Output {
        self.command().args(arguments).args(["--nats", &self.url]).output().unwrap()
    }

    pub(crate) fn work(&self, arguments: &[&str]) -> Process {
        self.spawn("work", arguments, Stdio::null())
    }

    pub(crate) fn spawn(&self, name: &str, arguments: &[&str], output: Stdio) -> Process {
        let mut command = self.command();
        command.arg(name).args(["--nats", &self.url]).args(arguments);
        Process(command.stdout(output).stderr(Stdio::null()).spawn().unwrap())
    }

    fn command(&self) -> Command {
        let mut command = Command::new(&self.path);
        command.current_dir(&self.folder).envs(self.variables.iter().cloned());
        command
    }

    /// Runs `submit`. Returns the lines about the added files.
    pub(crate) fn submit(&self, arguments: &[&str]) -> Vec<String> {
        let output = self.run(&[&["submit"], arguments].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        lines(&output)
    }

    /// Sorted results. Some may be missing while the server restarts.
    pub(crate) fn results(&self) -> Vec<String> {
        let mut lines = lines(&self.run(&["results"]));
        lines.sort();
        lines
    }
}

fn lines(output: &Output) -> Vec<String> {
    String::from_utf8(output.stdout.clone()).unwrap().lines().map(String::from).collect()
}

/// Folder that is deleted on drop.
pub(crate) struct Folder(pub(crate) PathBuf);

impl Folder {
    pub(crate) fn new(test: &str) -> Self {
        let path = std::env::temp_dir().join(format!("lockstep2d-worker-{}-{test}", std::process::id()));
        fs::create_dir_all(path.join("in")).unwrap();
        Folder(path)
    }

    pub(crate) fn write(&self, name: &str, bytes: &[u8]) {
        fs::write(self.0.join(name), bytes).unwrap();
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
