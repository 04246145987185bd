//! Reading a recording from its begin to its end.

use std::collections::HashMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};

use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{McapError, parse_record};
use rsapien_protocol::Direction;
use serde_json::Value;

use super::write::ABOUT;
use super::{About, RecordingError, Topic, json};

/// The longest record that is believed, in bytes: pictures are far smaller.
const RECORD_BYTES_MAX: usize = 256 << 20;

/// One message of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its channel.
    pub topic: Topic,
    /// When, in ms of the line's clock.
    pub time_ms: u64,
    /// When, in ns since 1970, as other programs see it.
    pub unix_ns: u64,
    data: Vec<u8>,
}

/// A message of [`Topic::Bytes`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BytesMessage {
    /// When, in ms of the line's clock.
    pub time_ms: u64,
    /// Which way they went.
    pub direction: Direction,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// A message of [`Topic::Camera`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// When it was taken, in ms of the line's clock.
    pub time_ms: u64,
    /// `jpeg` or `png`.
    pub format: String,
    /// The picture's file.
    pub data: Vec<u8>,
}

impl Entry {
    /// The message as it stands in the file.
    ///
    /// # Errors
    /// [`RecordingError::Message`] where it is no JSON.
    pub fn json(&self) -> Result<Value, RecordingError> {
        serde_json::from_slice(&self.data).map_err(|error| self.wrong(error.to_string()))
    }

    /// A message of [`Topic::Bytes`].
    ///
    /// # Errors
    /// [`RecordingError::Message`] where it is no such message.
    pub fn bytes(&self) -> Result<BytesMessage, RecordingError> {
        let value = self.json()?;
        let direction = match value["direction"].as_str() {
            Some("to-robot") => Direction::ToRobot,
            Some("to-pc") => Direction::ToPc,
            _ => return Err(self.wrong("its direction is neither to-robot nor to-pc")),
        };
        let bytes = value["hex"].as_str().and_then(json::from_hex);
        let bytes = bytes.ok_or_else(|| self.wrong("its bytes are no hexadecimal digits"))?;
        Ok(BytesMessage { time_ms: self.time_ms, direction, bytes })
    }

    /// A message of [`Topic::Camera`].
    ///
    /// # Errors
    /// [`RecordingError::Message`] where it is no such message.
    pub fn frame(&self) -> Result<Frame, RecordingError> {
        use base64::Engine as _;
        let value = self.json()?;
        let (Some(format), Some(data)) = (value["format"].as_str(), value["data"].as_str()) else {
            return Err(self.wrong("it has no format or no data"));
        };
        let data = base64::engine::general_purpose::STANDARD
            .decode(data)
            .map_err(|error| self.wrong(error.to_string()))?;
        Ok(Frame { time_ms: self.time_ms, format: format.to_owned(), data })
    }

    fn wrong(&self, why: impl Into<String>) -> RecordingError {
        RecordingError::Message { topic: self.topic.name(), why: why.into() }
    }
}

/// Gives the messages of a recording in the order in which they were written.
///
/// A file whose end is missing, because the program that wrote it was killed or still writes, is read
/// as far as it goes; [`is_cut`](RecordingReader::is_cut) tells. Messages of other programs' channels
/// are passed over.
pub struct RecordingReader {
    path: PathBuf,
    file: BufReader<File>,
    linear: LinearReader,
    channels: HashMap<u16, Option<Topic>>,
    about: About,
    origin_unix_ns: Option<u64>,
    /// The first message, which is looked for when the file is opened.
    first: Option<Entry>,
    is_cut: bool,
    is_over: bool,
}

impl RecordingReader {
    /// Opens a recording.
    ///
    /// # Errors
    /// [`RecordingError::File`], [`RecordingError::NotMcap`], [`RecordingError::NoChannels`] and
    /// [`RecordingError::Damaged`].
    pub fn open(path: impl AsRef<Path>) -> Result<RecordingReader, RecordingError> {
        let path = path.as_ref().to_owned();
        let file = File::open(&path).map_err(|source| RecordingError::File {
            action: "read",
            path: path.clone(),
            source,
        })?;
        let options = LinearReaderOptions::default()
            .with_validate_chunk_crcs(true)
            .with_record_length_limit(RECORD_BYTES_MAX);
        let mut reader = RecordingReader {
            path,
            file: BufReader::new(file),
            linear: LinearReader::new_with_options(options),
            channels: HashMap::new(),
            about: About::default(),
            origin_unix_ns: None,
            first: None,
            is_cut: false,
            is_over: false,
        };
        reader.first = reader.advance()?;
        let has_channels = reader.channels.values().any(Option::is_some);
        // A recording that was cut at once has channels, and no message yet.
        if !has_channels {
            return Err(RecordingError::NoChannels { path: reader.path });
        }
        Ok(reader)
    }

    /// What the recording is of.
    pub fn about(&self) -> &About {
        &self.about
    }

    /// Whether the end of the file is missing; known when the last message was given.
    pub fn is_cut(&self) -> bool {
        self.is_cut
    }

    fn advance(&mut self) -> Result<Option<Entry>, RecordingError> {
        while !self.is_over {
            let Some(event) = self.linear.next_event() else {
                self.is_over = true;
                break;
            };
            match event {
                Ok(LinearReadEvent::ReadRequest(need)) => {
                    let count = self.file.read(self.linear.insert(need));
                    let count = count.map_err(|source| RecordingError::File {
                        action: "read",
                        path: self.path.clone(),
                        source,
                    })?;
                    self.linear.notify_read(count);
                }
                Ok(LinearReadEvent::Record { opcode, data }) => {
                    let record = parse_record(opcode, data)
                        .map_err(|error| damaged(&self.path, &error))?
                        .into_owned();
                    if let Some(entry) = self.take(record) {
                        return Ok(Some(entry));
                    }
                }
                Err(error) => {
                    self.is_over = true;
                    match error {
                        McapError::UnexpectedEof if self.has_begun() => self.is_cut = true,
                        McapError::BadMagic | McapError::UnexpectedEof if !self.has_begun() => {
                            return Err(RecordingError::NotMcap { path: self.path.clone() });
                        }
                        error => return Err(damaged(&self.path, &error)),
                    }
                }
            }
        }
        Ok(None)
    }

    /// Whether anything but rubbish was read.
    fn has_begun(&self) -> bool {
        self.origin_unix_ns.is_some() || !self.channels.is_empty()
    }

    fn take(&mut self, record: Record<'_>) -> Option<Entry> {
        match record {
            Record::Channel(channel) => {
                let topic =
                    Topic::from_name(&channel.topic).filter(|_| channel.message_encoding == "json");
                self.channels.insert(channel.id, topic);
                None
            }
            Record::Metadata(metadata) if metadata.name == ABOUT => {
                self.about = About::of(&metadata.metadata);
                let origin = metadata.metadata.get("origin_unix_ns");
                self.origin_unix_ns = origin.and_then(|text| text.parse().ok());
                None
            }
            Record::Message { header, data } => {
                let topic = (*self.channels.get(&header.channel_id)?)?;
                // Without an origin, as in a file that another program has put together, the first
                // message is the origin.
                let origin = *self.origin_unix_ns.get_or_insert(header.log_time);
                let time_ms = header.log_time.saturating_sub(origin) / 1_000_000;
                let data = data.into_owned();
                Some(Entry { topic, time_ms, unix_ns: header.log_time, data })
            }
            _ => None,
        }
    }
}

impl Iterator for RecordingReader {
    type Item = Result<Entry, RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        match self.first.take() {
            Some(entry) => Some(Ok(entry)),
            None => self.advance().transpose(),
        }
    }
}

fn damaged(path: &Path, error: &McapError) -> RecordingError {
    RecordingError::Damaged { path: path.to_owned(), why: error.to_string() }
}
