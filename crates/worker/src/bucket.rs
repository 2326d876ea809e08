//! [`Bucket`]: files in a bucket of S3, or of a service with the same protocol.

use std::pin::Pin;
use std::time::Duration;

use futures_util::future;
use futures_util::stream::{self, StreamExt, TryStreamExt};
use object_store::aws::{AmazonS3, AmazonS3Builder};
use object_store::path::Path;
use object_store::prefix::PrefixStore;
use object_store::{ObjectStore, ObjectStoreExt, ObjectStoreScheme, RetryConfig};
use url::Url;

use crate::error::WorkerError;
use crate::submit::Names;

/// Time for which a request that fails is repeated. Requests to NATS are repeated for about the same time.
const RETRY: Duration = Duration::from_secs(60);

#[derive(Clone, Debug)]
pub(crate) struct Bucket {
    url: Url,
    store: PrefixStore<AmazonS3>,
}

impl Bucket {
    /// Opens a bucket. Credentials, region and endpoint come from the environment variables `AWS_*`.
    pub(crate) fn open(url: &Url) -> Result<Self, WorkerError> {
        let failed = WorkerError::bucket(url);
        let (_, folder) = ObjectStoreScheme::parse(url).map_err(|error| failed(error.into()))?;
        let retry = RetryConfig { retry_timeout: RETRY, ..RetryConfig::default() };
        let builder = AmazonS3Builder::from_env().with_url(url.as_str()).with_retry(retry);
        Ok(Bucket { url: url.clone(), store: PrefixStore::new(builder.build().map_err(&failed)?, folder) })
    }

    /// Names of the replays in the folder `name`, or in the whole bucket if `name` is empty. If there are no replays
    /// and `name` is an object, returns `name` itself.
    pub(crate) async fn replays(&self, name: &str) -> Result<Names<'_>, WorkerError> {
        let path = self.path(name)?;
        let failed = WorkerError::bucket(&self.url);
        let replay = |location: Path| (location.extension() == Some("replay")).then(|| location.into());
        let found = self.store.list(Some(&path)).map_err(WorkerError::bucket(&self.url));
        let found = found.try_filter_map(move |meta| future::ok(replay(meta.location)));
        let mut found = found.boxed().peekable();
        if Pin::new(&mut found).peek().await.is_some() {
            return Ok(found.boxed());
        }
        // The folder was tried first, because some services fail when the name of a folder is looked up as an object.
        match self.store.head(&path).await {
            Ok(_) if !name.is_empty() => Ok(stream::iter([Ok(path.into())]).boxed()),
            Ok(_) | Err(object_store::Error::NotFound { .. }) => {
                Err(WorkerError::NothingToSubmit { path: name.into() })
            }
            Err(error) => Err(failed(error)),
        }
    }

    /// BLAKE3 digest of an object, in 64 hexadecimal digits.
    pub(crate) async fn blake3(&self, name: &str) -> Result<String, WorkerError> {
        let failed = WorkerError::bucket(&self.url);
        let mut bytes = self.store.get(&self.path(name)?).await.map_err(&failed)?.into_stream();
        let mut hasher = blake3::Hasher::new();
        while let Some(bytes) = bytes.next().await {
            hasher.update(&bytes.map_err(&failed)?);
        }
        Ok(hasher.finalize().to_hex().to_string())
    }

    /// Reads at most `bytes_max + 1` bytes of an object.
    pub(crate) async fn read(&self, name: &str, bytes_max: u64) -> Result<Vec<u8>, WorkerError> {
        let failed = WorkerError::bucket(&self.url);
        let mut stream = self.store.get(&self.path(name)?).await.map_err(&failed)?.into_stream();
        let limit = usize::try_from(bytes_max.saturating_add(1)).unwrap_or(usize::MAX);
        let mut bytes = Vec::new();
        while bytes.len() < limit
            && let Some(part) = stream.next().await
        {
            bytes.extend_from_slice(&part.map_err(&failed)?);
        }
        bytes.truncate(limit);
        Ok(bytes)
    }

    fn path(&self, name: &str) -> Result<Path, WorkerError> {
        Path::parse(name).map_err(|error| WorkerError::bucket(&self.url)(error.into()))
    }
}
