//! [`serve`]: one connection from handshake to end.

use core::time::Duration;
use std::sync::Arc;

use futures_util::{SinkExt, StreamExt};
use tokio::net::TcpStream;
use tokio::time::{Instant, interval, timeout};
use tokio_tungstenite::tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tokio_tungstenite::tungstenite::http::StatusCode;
use tokio_tungstenite::tungstenite::protocol::{CloseFrame, WebSocketConfig, frame::coding::CloseCode};
use tokio_tungstenite::tungstenite::{Error, Message};
use tokio_tungstenite::{WebSocketStream, accept_hdr_async_with_config};

use super::Shared;
use super::limits::Limits;
use super::meter::{Bucket, Meter, Pace};
use super::metered::Metered;
use super::queue::{Next, Queue};
use super::rooms::Full;
use crate::frame::{ADDRESS_BYTES, Member, SECRET_BYTES, frame, unframe};

/// Timeout of the handshake, of the first frame after the handshake, and of the answer to a close frame.
const HANDSHAKE_MAX: Duration = Duration::from_secs(5);
/// Largest number of characters of a room code.
const CODE_MAX: usize = 32;
/// Number of pings that a silent member receives within the idle time.
const PINGS: u32 = 3;
/// Room in the write buffer for answers to pings, in bytes, in addition to one message. The answers collect there while
/// the client reads nothing.
const ANSWERS_MAX: usize = 64 * 1024;
/// Upper bound for the size of a member in the text frame with the list of members, in bytes.
const MEMBER_BYTES: usize = 32;

/// Code and text of a close frame.
type Reason = (u16, &'static str);

const CLOSE_SECRET: Reason = (4000, "expected a secret of 16 bytes");
const CLOSE_ROOM_FULL: Reason = (4001, "the room is full");
const CLOSE_RELAY_FULL: Reason = (4002, "the relay is full");
const CLOSE_REPLACED: Reason = (4003, "the member has connected again");
const CLOSE_FLOOD: Reason = (4004, "too many datagrams");

type Socket = WebSocketStream<Metered>;

pub(super) async fn serve(shared: &Shared, stream: TcpStream) -> Result<(), Error> {
    stream.set_nodelay(true)?;
    let mut code = String::new();
    let Limits { datagram_bytes, members, bytes_per_second, datagrams_per_second, .. } = shared.limits;
    let frame_max = ADDRESS_BYTES.saturating_add(datagram_bytes);
    let message_max = frame_max.saturating_add(members.saturating_mul(MEMBER_BYTES));
    let config = WebSocketConfig::default()
        .max_message_size(Some(frame_max))
        .max_frame_size(Some(frame_max))
        .read_buffer_size(8 * 1024)
        .write_buffer_size(8 * 1024)
        .max_write_buffer_size(message_max.saturating_add(ANSWERS_MAX));
    #[expect(clippy::result_large_err, reason = "the type is that of the callback")]
    let check = |request: &Request, response: Response| -> Result<Response, ErrorResponse> {
        code = admitted(request, &shared.limits.origins).map_err(refusal)?;
        Ok(response)
    };
    let accept = accept_hdr_async_with_config(Metered::new(stream), check, Some(config));
    let Ok(socket) = timeout(HANDSHAKE_MAX, accept).await else { return Ok(()) };
    let mut socket = socket?;
    socket.get_mut().limit(Bucket::of_connection(bytes_per_second, datagrams_per_second));
    let Ok(secret) = timeout(HANDSHAKE_MAX, first_frame(&mut socket)).await else { return Ok(()) };
    let Some(member) = secret?.as_deref().and_then(member_of) else {
        return close(&mut socket, CLOSE_SECRET).await;
    };
    let queue = Arc::new(Queue::new(shared.limits.queue_bytes));
    match shared.rooms.enter(&code, member, &queue, &shared.limits) {
        Ok(()) => {
            let mut connection = Connection { shared, socket, code, member, queue };
            let ended = connection.run().await;
            shared.rooms.leave(&connection.code, &connection.queue);
            let reason = match ended {
                Err(_) if connection.socket.get_ref().is_flood() => Some(CLOSE_FLOOD),
                ended => ended?,
            };
            match reason {
                Some(reason) => close(&mut connection.socket, reason).await,
                None => Ok(()),
            }
        }
        Err(Full::Room) => close(&mut socket, CLOSE_ROOM_FULL).await,
        Err(Full::Relay) => close(&mut socket, CLOSE_RELAY_FULL).await,
    }
}

/// Returns the room code of a request, in capital letters. If the relay refuses the request, returns the HTTP status.
fn admitted(request: &Request, origins: &[String]) -> Result<String, StatusCode> {
    let origin = request.headers().get("origin").map(|origin| origin.as_bytes());
    if origin.is_some_and(|origin| {
        !origins.is_empty() && !origins.iter().any(|allowed| allowed.as_bytes() == origin)
    }) {
        return Err(StatusCode::FORBIDDEN);
    }
    let code = request.uri().path().trim_start_matches('/').to_ascii_uppercase();
    let valid = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-';
    let is_code = (1..=CODE_MAX).contains(&code.len()) && code.bytes().all(valid);
    if is_code { Ok(code) } else { Err(StatusCode::NOT_FOUND) }
}

fn refusal(status: StatusCode) -> ErrorResponse {
    let mut response = ErrorResponse::new(None);
    *response.status_mut() = status;
    response
}

/// The first binary frame. `None` if the connection ends before it.
async fn first_frame(socket: &mut Socket) -> Result<Option<Vec<u8>>, Error> {
    while let Some(message) = socket.next().await {
        if let Message::Binary(bytes) = message? {
            return Ok(Some(bytes.to_vec()));
        }
    }
    Ok(None)
}

/// The address of the member with this secret. `None` if the secret has the wrong length. The address is a hash, which
/// does not reveal the secret. A secret gives the same address after a lost connection and after a restart of the
/// relay, so the relay need not store addresses.
fn member_of(secret: &[u8]) -> Option<Member> {
    let valid = secret.len() == SECRET_BYTES;
    valid.then(|| blake3::hash(secret).as_bytes().first_chunk().copied()).flatten()
}

/// Sends a close frame and reads until the client has answered it. If the relay left frames of the client unread, the
/// system would reset the connection, and the client could lose the close frame.
async fn close(socket: &mut Socket, (code, reason): Reason) -> Result<(), Error> {
    let frame = CloseFrame { code: CloseCode::from(code), reason: reason.into() };
    let closed = async {
        if socket.close(Some(frame)).await.is_ok() {
            while let Some(Ok(_)) = socket.next().await {}
        }
    };
    let _ = timeout(HANDSHAKE_MAX, closed).await;
    Ok(())
}

struct Connection<'a> {
    shared: &'a Shared,
    socket: Socket,
    code: String,
    member: Member,
    queue: Arc<Queue>,
}

impl Connection<'_> {
    /// Serves the member until the connection ends. Returns the reason if the relay has to close it.
    async fn run(&mut self) -> Result<Option<Reason>, Error> {
        let Limits { idle, bytes_per_second, datagrams_per_second, .. } = self.shared.limits;
        let mut meter = Meter::new(bytes_per_second, datagrams_per_second);
        let mut pings = interval((idle / PINGS).max(Duration::from_millis(1)));
        let start = Instant::now();
        let mut heard = start;
        loop {
            tokio::select! {
                message = self.socket.next() => {
                    let Some(message) = message else { return Ok(None) };
                    heard = Instant::now();
                    let message = message?;
                    if message.is_close() {
                        // Sends the answer to the close frame.
                        let _ = timeout(HANDSHAKE_MAX, self.socket.flush()).await;
                        return Ok(None);
                    }
                    match meter.count(start.elapsed(), message.len()) {
                        Pace::Fine => self.forward(&message),
                        Pace::Fast => {}
                        Pace::Flood => return Ok(Some(CLOSE_FLOOD)),
                    }
                }
                next = self.queue.next() => {
                    let message = match next {
                        Next::Frame(bytes) => Message::Binary(bytes.into()),
                        Next::Members => self.members(),
                        Next::Replaced => return Ok(Some(CLOSE_REPLACED)),
                    };
                    // A member that does not read for the idle time counts as gone.
                    let Ok(sent) = timeout(idle, self.socket.send(message)).await else { return Ok(None) };
                    sent?;
                }
                _ = pings.tick() => {
                    if heard.elapsed() > idle {
                        return Ok(None);
                    }
                    let ping = Message::Ping(Vec::new().into());
                    let Ok(sent) = timeout(idle, self.socket.send(ping)).await else { return Ok(None) };
                    sent?;
                }
            }
        }
    }

    /// Forwards a datagram. Replaces the address of the receiver in the frame by the address of the sender.
    fn forward(&self, message: &Message) {
        if let Message::Binary(bytes) = message
            && let Some((to, datagram)) = unframe(bytes)
        {
            self.shared.rooms.forward(&self.code, to, frame(self.member, datagram));
        }
    }

    fn members(&self) -> Message {
        let members = self.shared.rooms.members(&self.code, self.member);
        // A struct of strings can always be encoded.
        Message::text(serde_json::to_string(&members).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(uri: &str, origin: Option<&str>) -> Request {
        let mut request = Request::new(());
        *request.uri_mut() = uri.parse().unwrap();
        if let Some(origin) = origin {
            request.headers_mut().insert("origin", origin.parse().unwrap());
        }
        request
    }

    #[test]
    fn codes_and_origins_are_checked() {
        let code = |uri| admitted(&request(uri, None), &[]);
        assert_eq!(code("/abcd-7"), Ok("ABCD-7".to_owned()));
        for uri in ["/", "/a/b", "/a%20b", "/012345678901234567890123456789012"] {
            assert_eq!(code(uri), Err(StatusCode::NOT_FOUND), "{uri}");
        }
        let origins = ["https://game.example".to_owned()];
        assert_eq!(admitted(&request("/A", None), &origins), Ok("A".to_owned()));
        assert_eq!(admitted(&request("/A", Some("https://game.example")), &origins), Ok("A".to_owned()));
        assert_eq!(
            admitted(&request("/A", Some("https://other.example")), &origins),
            Err(StatusCode::FORBIDDEN)
        );
    }

    #[test]
    fn a_secret_has_one_address() {
        assert_eq!(member_of(&[1; 16]), member_of(&[1; 16]));
        assert_ne!(member_of(&[1; 16]), member_of(&[2; 16]));
        assert_eq!(member_of(&[1; 15]), None);
    }
}
