//! The relay as a program.

use std::error::Error;
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use lockstep2d_relay::{Limits, Server};
use serde_json::json;

/// Forwards datagrams between the members of rooms over WebSockets. A client connects to ws://ADDRESS/CODE, where CODE
/// is the code of its room.
///
/// Exit codes: 0 ended by Ctrl-C or SIGTERM, 1 cannot listen on the address, 2 wrong arguments.
#[derive(Debug, Parser)]
#[command(version)]
struct Arguments {
    /// Address and port to listen on; with port 0 the system chooses one
    #[arg(long, default_value = "127.0.0.1:7010")]
    listen: String,
    /// Origin of web pages that may connect, such as https://game.example; may be repeated [default: all]
    #[arg(long = "origin")]
    origins: Vec<String>,
    /// Maximum number of connections
    #[arg(long, default_value_t = Limits::default().connections)]
    connections: usize,
    /// Maximum number of rooms
    #[arg(long, default_value_t = Limits::default().rooms)]
    rooms: usize,
    /// Maximum number of members of a room
    #[arg(long, default_value_t = Limits::default().members)]
    members: usize,
    /// Maximum size of a datagram in bytes
    #[arg(long, default_value_t = Limits::default().datagram_bytes)]
    datagram_bytes: usize,
    /// Maximum memory in bytes of the datagrams that wait for one member; the oldest are dropped
    #[arg(long, default_value_t = Limits::default().queue_bytes)]
    queue_bytes: usize,
    /// Maximum bytes per second from one member
    #[arg(long, default_value_t = Limits::default().bytes_per_second)]
    bytes_per_second: u32,
    /// Maximum datagrams per second from one member
    #[arg(long, default_value_t = Limits::default().datagrams_per_second)]
    datagrams_per_second: u32,
    /// Seconds without a frame after which a member is disconnected
    #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u64).range(1..=3600))]
    idle_seconds: u64,
    /// Print the address of the relay as a line of JSON
    #[arg(long)]
    json: bool,
}

impl Arguments {
    fn limits(&self) -> Limits {
        Limits {
            connections: self.connections,
            rooms: self.rooms,
            members: self.members,
            datagram_bytes: self.datagram_bytes,
            queue_bytes: self.queue_bytes,
            bytes_per_second: self.bytes_per_second,
            datagrams_per_second: self.datagrams_per_second,
            idle: Duration::from_secs(self.idle_seconds),
            origins: self.origins.clone(),
        }
    }
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match serve(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}: {error}", arguments.listen);
            ExitCode::FAILURE
        }
    }
}

#[tokio::main(flavor = "current_thread")]
async fn serve(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let server = Server::bind(&arguments.listen, arguments.limits()).await?;
    let address = format!("ws://{}", server.address()?);
    if arguments.json {
        println!("{}", json!({ "event": "listening", "address": address }));
    } else {
        println!("listening on {address}");
    }
    tokio::select! {
        () = server.run() => {}
        ended = terminated() => ended?,
    }
    Ok(())
}

async fn terminated() -> std::io::Result<()> {
    #[cfg(unix)]
    {
        let mut terminate = tokio::signal::unix::signal(tokio::signal::unix::SignalKind::terminate())?;
        tokio::select! {
            interrupted = tokio::signal::ctrl_c() => interrupted,
            _ = terminate.recv() => Ok(()),
        }
    }
    #[cfg(not(unix))]
    tokio::signal::ctrl_c().await
}
