//! `Recording`: a recording as numpy arrays; and `Recorder`, which `Robot.record` gives.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use numpy::{Element, PyArray1, PyArray3};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use rsapien::protocol::{BumperMask, Joint};
use rsapien::recording::{About, Entry, Recorder, RecordingReader, Topic};
use rsapien_vision::Picture;
use serde_json::Value;

use crate::detection::FIELDS;
use crate::errors::{RecordingError, recording_error};
use crate::picture::to_numpy;

/// A recording, read anew from its file by each call.
#[pyclass(name = "Recording", module = "rsapien", frozen)]
pub(crate) struct PyRecording {
    path: PathBuf,
    about: About,
    counts: BTreeMap<Topic, u64>,
    range_ms: Option<(u64, u64)>,
    is_cut: bool,
}

impl PyRecording {
    fn count(&self, topic: Topic) -> u64 {
        self.counts.get(&topic).copied().unwrap_or(0)
    }

    /// Every message of a channel, as `read` takes it.
    fn each<T: Send>(
        &self,
        py: Python<'_>,
        topic: Topic,
        read: impl Fn(Entry) -> Result<T, rsapien::recording::RecordingError> + Sync,
    ) -> PyResult<Vec<T>> {
        let messages = py.detach(|| {
            RecordingReader::open(&self.path)?
                .filter(|entry| entry.as_ref().map_or(true, |entry| entry.topic == topic))
                .map(|entry| read(entry?))
                .collect::<Result<Vec<T>, _>>()
        });
        messages.map_err(recording_error)
    }

    /// Every message of a channel as a dictionary.
    fn dictionaries<'py>(&self, py: Python<'py>, topic: Topic) -> PyResult<Bound<'py, PyList>> {
        let texts = self.each(py, topic, |entry| Ok(entry.json()?.to_string()))?;
        let loads = py.import("json")?.getattr("loads")?;
        let list = PyList::empty(py);
        for text in texts {
            list.append(loads.call1((text,))?)?;
        }
        Ok(list)
    }
}

#[pymethods]
impl PyRecording {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        py.detach(|| {
            let mut reader = RecordingReader::open(&path)?;
            let about = reader.about().clone();
            let (mut counts, mut range_ms) = (BTreeMap::new(), None);
            for entry in reader.by_ref() {
                let entry = entry?;
                *counts.entry(entry.topic).or_insert(0) += 1;
                let now = entry.time_ms;
                let (first, last) = range_ms.unwrap_or((now, now));
                range_ms = Some((now.min(first), now.max(last)));
            }
            let is_cut = reader.is_cut();
            Ok(PyRecording { path, about, counts, range_ms, is_cut })
        })
        .map_err(recording_error)
    }

    #[getter]
    fn topics(&self) -> BTreeMap<&'static str, u64> {
        self.counts.iter().map(|(topic, count)| (topic.name(), *count)).collect()
    }

    #[getter]
    fn time_range(&self) -> Option<(u64, u64)> {
        self.range_ms
    }

    #[getter]
    fn complete(&self) -> bool {
        !self.is_cut
    }

    #[getter]
    fn about<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let about = PyDict::new(py);
        about.set_item("program", &self.about.program)?;
        about.set_item("link", &self.about.link)?;
        about.set_item("baud", self.about.baud)?;
        about.set_item("seed", self.about.seed)?;
        about.set_item("controllers", &self.about.controllers)?;
        about.set_item("fast", self.about.is_fast)?;
        Ok(about)
    }

    fn states<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let states = self.each(py, Topic::State, |entry| entry.json())?;
        let joints = Joint::ALL.map(Joint::name);
        let group = |names: &[&'static str], kind: &'static str| -> PyResult<Bound<'py, PyAny>> {
            Ok(PyList::new(py, names.iter().map(|name| (*name, kind)))?.into_any())
        };
        let fields = PyList::empty(py);
        for (name, kind) in [("time_ms", "u8"), ("mode", "U12"), ("cause", "U9")] {
            fields.append((name, kind))?;
        }
        fields.append(("bumpers", group(&BumperMask::NAMES, "?")?))?;
        fields.append(("presses", group(&BumperMask::NAMES, "u1")?))?;
        fields.append(("motors", group(&joints, "?")?))?;
        fields.append(("pose", group(&joints, "u1")?))?;
        for (name, kind) in [
            ("supply_low", "?"),
            ("queue_free", "u1"),
            ("steps_ended", "u2"),
            ("boot", "u1"),
            ("pan", "f8"),
            ("tilt", "f8"),
            ("pan_target", "f8"),
            ("tilt_target", "f8"),
        ] {
            fields.append((name, kind))?;
        }
        let array = py.import("numpy")?.call_method1("zeros", (states.len(), fields))?;
        let number = |path: &str| column(&states, path, |value| value.as_u64().unwrap_or(0));
        let truth = |path: &str| column(&states, path, |value| value.as_bool().unwrap_or(false));
        let degrees = |path: &str| column(&states, path, |it| it.as_f64().unwrap_or(f64::NAN));
        put(&array, "time_ms", number("/time_ms"))?;
        for name in ["mode", "cause"] {
            let words = column(&states, &format!("/motion/{name}"), |value| {
                value.as_str().unwrap_or_default().to_owned()
            });
            array.set_item(name, PyList::new(py, words)?)?;
        }
        let groups: [(&str, &[&str]); 2] = [("bumpers", &BumperMask::NAMES), ("motors", &joints)];
        for (group, names) in groups {
            let part = array.get_item(group)?;
            for name in names {
                put(&part, name, truth(&format!("/motion/{group}/{name}")))?;
            }
        }
        let groups: [(&str, &[&str]); 2] = [("presses", &BumperMask::NAMES), ("pose", &joints)];
        for (group, names) in groups {
            let part = array.get_item(group)?;
            for name in names {
                put(&part, name, number(&format!("/motion/{group}/{name}")))?;
            }
        }
        put(&array, "supply_low", truth("/motion/supply_low"))?;
        for name in ["queue_free", "steps_ended", "boot"] {
            put(&array, name, number(&format!("/motion/{name}")))?;
        }
        for name in ["pan", "tilt", "pan_target", "tilt_target"] {
            put(&array, name, degrees(&format!("/camera/{name}_deg")))?;
        }
        Ok(array)
    }

    fn packages<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        self.dictionaries(py, Topic::Packages)
    }

    fn motion<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        self.dictionaries(py, Topic::Motion)
    }

    fn bytes<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Vec<(u64, &'static str, Bound<'py, PyBytes>)>> {
        let messages = self.each(py, Topic::Bytes, |entry| entry.bytes())?;
        let direction = |it| match it {
            rsapien::protocol::Direction::ToRobot => "to-robot",
            rsapien::protocol::Direction::ToPc => "to-pc",
        };
        let told = messages.iter().map(|message| {
            let bytes = PyBytes::new(py, &message.bytes);
            (message.time_ms, direction(message.direction), bytes)
        });
        Ok(told.collect())
    }

    fn frames(&self) -> PyResult<PyFrames> {
        let reader = RecordingReader::open(&self.path).map_err(recording_error)?;
        Ok(PyFrames { reader: Mutex::new(reader) })
    }

    fn detections<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let messages =
            self.each(py, Topic::Detections, |entry| Ok((entry.time_ms, entry.json()?)))?;
        let rows: Vec<(u64, &Value)> = messages
            .iter()
            .flat_map(|(time_ms, message)| {
                let ellipses = message["ellipses"].as_array().map_or(&[][..], Vec::as_slice);
                ellipses.iter().map(|ellipse| (*time_ms, ellipse))
            })
            .collect();
        let fields = PyList::empty(py);
        fields.append(("time_ms", "u8"))?;
        for name in FIELDS {
            fields.append((name, "f8"))?;
        }
        let array = py.import("numpy")?.call_method1("zeros", (rows.len(), fields))?;
        put(&array, "time_ms", rows.iter().map(|(time_ms, _)| *time_ms).collect())?;
        for name in FIELDS {
            let value = |(_, ellipse): &(u64, &Value)| ellipse[name].as_f64().unwrap_or(f64::NAN);
            put(&array, name, rows.iter().map(value).collect())?;
        }
        Ok(array)
    }

    fn __repr__(&self) -> String {
        let seconds = self.range_ms.map_or(0, |(first, last)| (last - first + 50) / 100);
        let mut text = format!(
            "Recording({:?}: {}.{} s, {} packages, {} states",
            self.path.display().to_string(),
            seconds / 10,
            seconds % 10,
            self.count(Topic::Packages),
            self.count(Topic::State),
        );
        for (topic, what) in [(Topic::Camera, "frames"), (Topic::Detections, "detections")] {
            if self.count(topic) > 0 {
                text = format!("{text}, {} {what}", self.count(topic));
            }
        }
        if self.is_cut {
            text.push_str(", cut");
        }
        text + ")"
    }
}

fn column<T>(states: &[Value], path: &str, read: impl Fn(&Value) -> T) -> Vec<T> {
    states.iter().map(|state| read(state.pointer(path).unwrap_or(&Value::Null))).collect()
}

fn put<T: Element>(array: &Bound<'_, PyAny>, name: &str, values: Vec<T>) -> PyResult<()> {
    array.set_item(name, PyArray1::from_vec(array.py(), values))
}

/// The pictures of a recording, one after the other.
#[pyclass(name = "Frames", module = "rsapien", frozen)]
pub(crate) struct PyFrames {
    reader: Mutex<RecordingReader>,
}

/// When, and the picture.
type FrameTold<'py> = (u64, Bound<'py, PyArray3<u8>>);

#[pymethods]
impl PyFrames {
    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    fn __next__<'py>(&self, py: Python<'py>) -> PyResult<Option<FrameTold<'py>>> {
        let frame = py.detach(|| {
            let mut reader = self.reader.lock().unwrap_or_else(PoisonError::into_inner);
            let is_frame = |entry: &Result<Entry, _>| {
                entry.as_ref().map_or(true, |entry| entry.topic == Topic::Camera)
            };
            reader.by_ref().find(is_frame).map(|entry| entry?.frame()).transpose()
        });
        let Some(frame) = frame.map_err(recording_error)? else { return Ok(None) };
        let picture = Picture::decode(&frame.data)
            .map_err(|error| RecordingError::new_err(format!("a picture: {error}")))?;
        Ok(Some((frame.time_ms, to_numpy(py, &picture)?)))
    }
}

/// Where a robot's line finds the recorder, if there is one.
pub(crate) type RecorderSlot = Arc<Mutex<Option<Recorder>>>;

/// A recording that is being written. Use it in a `with`.
#[pyclass(name = "Recorder", module = "rsapien", frozen)]
pub(crate) struct PyRecorder {
    recorder: Recorder,
    slot: RecorderSlot,
    path: PathBuf,
}

impl PyRecorder {
    pub(crate) fn begin(
        path: PathBuf,
        overwrite: bool,
        about: &About,
        slot: &RecorderSlot,
    ) -> PyResult<PyRecorder> {
        let mut place = slot.lock().unwrap_or_else(PoisonError::into_inner);
        if place.is_some() {
            let told = "the robot is being recorded already: finish that recording first";
            return Err(RecordingError::new_err(told));
        }
        let recorder = Recorder::create(&path, overwrite).map_err(recording_error)?;
        recorder.describe(about);
        *place = Some(recorder.clone());
        Ok(PyRecorder { recorder, slot: Arc::clone(slot), path })
    }
}

#[pymethods]
impl PyRecorder {
    fn finish(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| {
            // Not with the place held: the line's thread looks there while it is written.
            let recorder = self.slot.lock().unwrap_or_else(PoisonError::into_inner).take();
            drop(recorder);
            self.recorder.finish()
        })
        .map(|_| ())
        .map_err(recording_error)
    }

    fn __enter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    #[pyo3(signature = (_kind=None, _error=None, _traceback=None))]
    fn __exit__(
        &self,
        py: Python<'_>,
        _kind: Option<&Bound<'_, PyAny>>,
        _error: Option<&Bound<'_, PyAny>>,
        _traceback: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        self.finish(py)
    }

    fn __repr__(&self) -> String {
        format!("Recorder({:?})", self.path.display().to_string())
    }
}
