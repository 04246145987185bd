//! Writing a recording.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use mcap::records::{MessageHeader, Metadata};
use mcap::{Compression, McapError, McapResult, WriteOptions};
use rsapien_protocol::{Direction, Fed, Receiver};
use rsapien_vision::{Ellipse, Picture};
use serde_json::Value;

use super::{RecordingError, Topic, json};
use crate::{LineEvent, LineSink, PackageRecord};

/// What is not on the disk yet is at most so old; a program that is killed loses no more.
const FLUSH_AFTER: Duration = Duration::from_millis(250);
/// The largest chunk before it is compressed, in bytes.
const CHUNK_BYTES: u64 = 1 << 20;
/// The name of the metadata that [`About`] is kept under.
pub(super) const ABOUT: &str = "rsapien";

/// What a recording is of. It stands in the file as metadata.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct About {
    /// What was run, as it was called.
    pub program: String,
    /// The link's address.
    pub link: String,
    /// Speed of the line in bit/s.
    pub baud: u32,
    /// Of the virtual robot in the same process: its seed.
    pub seed: Option<u64>,
    /// Of the virtual robot in the same process: its world, as JSON.
    pub world: Option<String>,
    /// Of the virtual robot in the same process: `model` or `firmware`.
    pub controllers: Option<String>,
    /// Whether its time passed as fast as it went, so that its run is the same each time.
    pub is_fast: bool,
}

impl About {
    /// Whether it was recorded on the virtual robot's model, which can be made again.
    pub fn is_of_model(&self) -> bool {
        self.controllers.as_deref() == Some("model")
    }

    fn metadata(&self, origin_unix_ns: u64) -> BTreeMap<String, String> {
        let mut pairs = vec![
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("program", self.program.clone()),
            ("link", self.link.clone()),
            ("baud", self.baud.to_string()),
            ("fast", self.is_fast.to_string()),
            ("origin_unix_ns", origin_unix_ns.to_string()),
        ];
        let seed = self.seed.map(|seed| seed.to_string());
        for (key, value) in
            [("seed", &seed), ("world", &self.world), ("controllers", &self.controllers)]
        {
            if let Some(value) = value {
                pairs.push((key, value.clone()));
            }
        }
        pairs.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
    }

    pub(super) fn of(metadata: &BTreeMap<String, String>) -> About {
        let get = |key: &str| metadata.get(key).cloned();
        About {
            program: get("program").unwrap_or_default(),
            link: get("link").unwrap_or_default(),
            baud: get("baud").and_then(|baud| baud.parse().ok()).unwrap_or(57_600),
            seed: get("seed").and_then(|seed| seed.parse().ok()),
            world: get("world"),
            controllers: get("controllers"),
            is_fast: get("fast").is_some_and(|fast| fast == "true"),
        }
    }
}

/// What a finished recording holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RecordingSummary {
    /// The file.
    pub path: PathBuf,
    /// How many messages each channel has; only those with some.
    pub messages: Vec<(Topic, u32)>,
    /// From the first message to the last, in ms of the line's clock.
    pub duration_ms: u64,
}

/// Writes a recording. Clones write to the same file, which is finished by [`finish`](Recorder::finish)
/// or when the last clone goes.
#[derive(Clone, Debug)]
pub struct Recorder {
    writing: Arc<Mutex<Writing>>,
}

struct Writing {
    path: PathBuf,
    /// None once it is finished.
    writer: Option<mcap::Writer<BufWriter<File>>>,
    origin_unix_ns: u64,
    is_described: bool,
    channels: Vec<(Topic, u16)>,
    counts: [u32; Topic::ALL.len()],
    range_ms: Option<(u64, u64)>,
    flushed: Instant,
    /// What went wrong first; nothing is written after it.
    failure: Option<McapError>,
}

impl std::fmt::Debug for Writing {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Writing").field("path", &self.path).finish_non_exhaustive()
    }
}

impl Recorder {
    /// Begins a recording in a new file; one that is there is replaced only if `overwrite` says so.
    ///
    /// # Errors
    /// [`RecordingError::Exists`] and [`RecordingError::File`].
    pub fn create(path: impl AsRef<Path>, overwrite: bool) -> Result<Recorder, RecordingError> {
        let path = path.as_ref().to_owned();
        let mut options = OpenOptions::new();
        options.write(true);
        if overwrite {
            options.create(true).truncate(true);
        } else {
            options.create_new(true);
        }
        let file = options.open(&path).map_err(|source| {
            if source.kind() == std::io::ErrorKind::AlreadyExists {
                return RecordingError::Exists { path: path.clone() };
            }
            RecordingError::File { action: "write", path: path.clone(), source }
        })?;
        let origin = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let mut writing = Writing {
            path,
            writer: None,
            origin_unix_ns: u64::try_from(origin.as_nanos()).unwrap_or(u64::MAX / 2),
            is_described: false,
            channels: Vec::new(),
            counts: [0; Topic::ALL.len()],
            range_ms: None,
            flushed: Instant::now(),
            failure: None,
        };
        let begun = writing.begin(file);
        begun.map_err(|error| writing.error(error))?;
        Ok(Recorder { writing: Arc::new(Mutex::new(writing)) })
    }

    /// Keeps what the recording is of. The first one counts.
    pub fn describe(&self, about: &About) {
        let mut writing = self.writing();
        if !std::mem::replace(&mut writing.is_described, true) {
            let metadata = about.metadata(writing.origin_unix_ns);
            writing.attempt(|writer| {
                writer.write_metadata(&Metadata { name: ABOUT.to_owned(), metadata })?;
                writer.flush()
            });
        }
    }

    /// What keeps everything that happens on a line, for [`RobotOptions::on_line`](crate::RobotOptions).
    pub fn line_sink(&self) -> LineSink {
        let recorder = self.clone();
        Box::new(move |event| recorder.line_event(event))
    }

    /// Keeps one thing that happened on the line.
    pub fn line_event(&self, event: &LineEvent<'_>) {
        let mut writing = self.writing();
        match event {
            LineEvent::Sent { time_ms, bytes } => {
                let value = json::bytes(*time_ms, Direction::ToRobot, bytes);
                writing.message(Topic::Bytes, *time_ms, &value);
            }
            LineEvent::Received { time_ms, bytes } => {
                let value = json::bytes(*time_ms, Direction::ToPc, bytes);
                writing.message(Topic::Bytes, *time_ms, &value);
            }
            LineEvent::Package(record) => {
                let value = json::package(record, content_of(record).as_ref());
                writing.message(Topic::Packages, record.time_ms, &value);
            }
            LineEvent::State(state) => {
                writing.message(Topic::State, state.time_ms, &json::state(state));
            }
        }
    }

    /// Keeps what happens to an action: an object with `event` and what belongs to it, as the schema of
    /// [`Topic::Motion`] says; `time_ms` is added.
    pub fn motion(&self, time_ms: u64, mut event: Value) {
        if let Some(object) = event.as_object_mut() {
            object.insert("time_ms".to_owned(), time_ms.into());
        }
        self.writing().message(Topic::Motion, time_ms, &event);
    }

    /// Keeps a picture, as JPEG.
    pub fn frame(&self, time_ms: u64, picture: &Picture) {
        // Made before the lock is taken: the line's thread may wait for it.
        match crate::video::encode_jpeg(picture) {
            Ok(data) => {
                let mut writing = self.writing();
                let value = json::frame(writing.unix_ns(time_ms), "jpeg", &data);
                writing.message(Topic::Camera, time_ms, &value);
            }
            Err(error) => tracing::warn!(%error, "a picture was not recorded"),
        }
    }

    /// Keeps the ellipses found in the picture of `time_ms`, each with its score.
    pub fn detections(&self, time_ms: u64, found: &[(Ellipse, f64)]) {
        let mut writing = self.writing();
        writing.message(Topic::Detections, time_ms, &json::detections(time_ms, found));
        let lines = json::annotations(writing.unix_ns(time_ms), found);
        writing.message(Topic::Annotations, time_ms, &lines);
    }

    /// Ends the file: its index is written. Later events are not recorded any more.
    ///
    /// # Errors
    /// [`RecordingError::File`], also of an earlier write that failed.
    pub fn finish(&self) -> Result<RecordingSummary, RecordingError> {
        let mut writing = self.writing();
        writing.attempt(|writer| writer.finish().map(|_| ()));
        writing.writer = None;
        if let Some(error) = writing.failure.take() {
            return Err(writing.error(error));
        }
        let count = |topic: Topic| (topic, writing.counts[topic as usize]);
        let messages = Topic::ALL.map(count).into_iter().filter(|(_, count)| *count > 0);
        Ok(RecordingSummary {
            path: writing.path.clone(),
            messages: messages.collect(),
            duration_ms: writing.range_ms.map_or(0, |(first, last)| last - first),
        })
    }

    fn writing(&self) -> MutexGuard<'_, Writing> {
        self.writing.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Writing {
    fn begin(&mut self, file: File) -> McapResult<()> {
        let mut writer = WriteOptions::new()
            .compression(Some(Compression::Lz4))
            .chunk_size(Some(CHUNK_BYTES))
            // A chunk is written whole, or a program that is killed would leave half of one.
            .disable_seeking(true)
            .library(concat!("rsapien ", env!("CARGO_PKG_VERSION")))
            .create(BufWriter::new(file))?;
        for topic in Topic::ALL {
            let schema = serde_json::to_vec(&topic.schema()).unwrap_or_default();
            let schema = writer.add_schema(topic.schema_name(), "jsonschema", &schema)?;
            let channel = writer.add_channel(schema, topic.name(), "json", &BTreeMap::new())?;
            self.channels.push((topic, channel));
        }
        writer.flush()?;
        self.writer = Some(writer);
        Ok(())
    }

    fn unix_ns(&self, time_ms: u64) -> u64 {
        self.origin_unix_ns.saturating_add(time_ms.saturating_mul(1_000_000))
    }

    fn message(&mut self, topic: Topic, time_ms: u64, value: &Value) {
        let Some((_, channel_id)) = self.channels.get(topic as usize).copied() else { return };
        let sequence = self.counts[topic as usize];
        let log_time = self.unix_ns(time_ms);
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        let is_due = self.flushed.elapsed() >= FLUSH_AFTER;
        let data = value.to_string();
        let written = self.attempt(|writer| {
            writer.write_to_known_channel(&header, data.as_bytes())?;
            if is_due { writer.flush() } else { Ok(()) }
        });
        if written {
            self.counts[topic as usize] = sequence.wrapping_add(1);
            let (first, last) = self.range_ms.unwrap_or((time_ms, time_ms));
            self.range_ms = Some((first.min(time_ms), last.max(time_ms)));
        }
        if is_due {
            self.flushed = Instant::now();
        }
    }

    /// Writes, unless it is finished or something went wrong before.
    fn attempt(
        &mut self,
        write: impl FnOnce(&mut mcap::Writer<BufWriter<File>>) -> McapResult<()>,
    ) -> bool {
        let Some(writer) = self.writer.as_mut().filter(|_| self.failure.is_none()) else {
            return false;
        };
        match write(writer) {
            Ok(()) => true,
            Err(error) => {
                tracing::warn!(%error, "the recording {} ends here", self.path.display());
                self.failure = Some(error);
                false
            }
        }
    }

    fn error(&self, error: McapError) -> RecordingError {
        let source = match error {
            McapError::Io(source) => source,
            other => std::io::Error::other(other.to_string()),
        };
        RecordingError::File { action: "write", path: self.path.clone(), source }
    }
}

fn content_of(record: &PackageRecord) -> Option<rsapien_protocol::Content> {
    let mut receiver = Receiver::listening(record.direction);
    record.bytes.iter().find_map(|byte| match receiver.feed(*byte, 0) {
        Fed::Package(content) => Some(content),
        _ => None,
    })
}
