//! [`Metered`]: a TCP stream that limits the rate of the bytes it receives.

use std::io;
use std::pin::Pin;
use std::task::{Context, Poll, ready};

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;
use tokio::time::Instant;

use super::meter::Bucket;

/// A TCP stream. Bytes are counted here and not only in complete messages, because a client can send fragments of a
/// message for ever.
pub(super) struct Metered {
    stream: TcpStream,
    limit: Option<(Bucket, Instant)>,
    is_flood: bool,
}

impl Metered {
    /// A stream without a limit.
    pub(super) fn new(stream: TcpStream) -> Self {
        Metered { stream, limit: None, is_flood: false }
    }

    /// Limits the bytes that are read from now on.
    pub(super) fn limit(&mut self, bucket: Bucket) {
        self.limit = Some((bucket, Instant::now()));
    }

    /// Whether reading has failed because the limit is exceeded.
    pub(super) fn is_flood(&self) -> bool {
        self.is_flood
    }
}

impl AsyncRead for Metered {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buf: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = buf.filled().len();
        ready!(Pin::new(&mut self.stream).poll_read(cx, buf))?;
        let count = buf.filled().len() - before;
        if let Some((bucket, start)) = &mut self.limit
            && !bucket.take(start.elapsed(), count)
        {
            self.is_flood = true;
            return Poll::Ready(Err(io::Error::other("too many bytes")));
        }
        Poll::Ready(Ok(()))
    }
}

impl AsyncWrite for Metered {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.stream).poll_write(cx, bytes)
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}
