//! The channels of a recording and their JSON schemas.

use serde_json::{Value, json};

/// A channel of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Topic {
    /// Every byte both ways.
    Bytes,
    /// Every package, with its meaning.
    Packages,
    /// The robot's state, each time it was renewed.
    State,
    /// What was played, how far it was, and how it ended.
    Motion,
    /// Pictures.
    Camera,
    /// The ellipses found in a picture.
    Detections,
    /// The same as lines over the picture, for Foxglove.
    Annotations,
}

impl Topic {
    /// All, in the order of their channels.
    pub const ALL: [Topic; 7] = [
        Topic::Bytes,
        Topic::Packages,
        Topic::State,
        Topic::Motion,
        Topic::Camera,
        Topic::Detections,
        Topic::Annotations,
    ];

    /// The name of the channel in the file.
    pub const fn name(self) -> &'static str {
        match self {
            Topic::Bytes => "/rsapien/bytes",
            Topic::Packages => "/rsapien/packages",
            Topic::State => "/rsapien/state",
            Topic::Motion => "/rsapien/motion",
            Topic::Camera => "/rsapien/camera",
            Topic::Detections => "/rsapien/detections",
            Topic::Annotations => "/rsapien/annotations",
        }
    }

    /// The channel of this name.
    pub fn from_name(name: &str) -> Option<Topic> {
        Topic::ALL.into_iter().find(|topic| topic.name() == name)
    }

    /// The name of the schema; Foxglove knows those that begin with its own.
    pub const fn schema_name(self) -> &'static str {
        match self {
            Topic::Bytes => "rsapien.Bytes",
            Topic::Packages => "rsapien.Package",
            Topic::State => "rsapien.State",
            Topic::Motion => "rsapien.Motion",
            Topic::Camera => "foxglove.CompressedImage",
            Topic::Detections => "rsapien.Detections",
            Topic::Annotations => "foxglove.ImageAnnotations",
        }
    }

    /// The JSON schema of its messages.
    pub fn schema(self) -> Value {
        let (properties, required) = match self {
            Topic::Bytes => bytes(),
            Topic::Packages => packages(),
            Topic::State => state(),
            Topic::Motion => motion(),
            Topic::Camera => camera(),
            Topic::Detections => detections(),
            Topic::Annotations => annotations(),
        };
        json!({
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "title": self.schema_name(),
            "type": "object",
            "properties": properties,
            "required": required,
        })
    }
}

type Schema = (Value, &'static [&'static str]);

fn time_ms() -> Value {
    json!({"type": "integer", "minimum": 0, "description": "ms of the line's clock"})
}

fn text(description: &str) -> Value {
    json!({"type": "string", "description": description})
}

fn integer(description: &str) -> Value {
    json!({"type": "integer", "description": description})
}

fn direction() -> Value {
    json!({"type": "string", "enum": ["to-robot", "to-pc"]})
}

fn hex() -> Value {
    text("the bytes on the line, two hexadecimal digits each")
}

fn bytes() -> Schema {
    (
        json!({"time_ms": time_ms(), "direction": direction(), "hex": hex()}),
        &["time_ms", "direction", "hex"],
    )
}

fn packages() -> Schema {
    (
        json!({
            "time_ms": time_ms(),
            "direction": direction(),
            "controller": {"type": "string", "enum": ["motion", "camera"]},
            "kind": text("HELLO, STATE, STEP, ..."),
            "session": integer("0 to 255"),
            "sequence": integer("0 to 255"),
            "status": text("of answers: accepted, or why not"),
            "words": text("what it says"),
            "hex": hex(),
        }),
        &["time_ms", "direction", "controller", "hex"],
    )
}

fn state() -> Schema {
    (
        json!({
            "time_ms": time_ms(),
            "version": integer("one more at each renewal"),
            "link": {"type": "string", "enum": ["up", "silent", "lost"]},
            "motion": {"type": ["object", "null"], "description": "the motion controller's last report"},
            "camera": {"type": ["object", "null"], "description": "the camera controller's last report"},
            "counts": {"type": "object", "description": "what happened on the line so far"},
        }),
        &["time_ms", "version", "link"],
    )
}

fn motion() -> Schema {
    (
        json!({
            "time_ms": time_ms(),
            "event": {"type": "string", "enum": ["begin", "step", "end"]},
            "action": text("what is played"),
            "steps_ended": integer("of its steps"),
            "steps_total": integer("how many it has"),
            "label": {"type": ["string", "null"], "description": "the label last passed"},
            "outcome": text("at the end: done, refused, interrupted, unknown"),
            "detail": {"type": ["string", "null"], "description": "by what, or why"},
        }),
        &["time_ms", "event"],
    )
}

/// A time as Foxglove writes it.
fn foxglove_time() -> Value {
    json!({
        "type": "object",
        "title": "time",
        "properties": {
            "sec": {"type": "integer", "minimum": 0},
            "nsec": {"type": "integer", "minimum": 0, "maximum": 999_999_999},
        },
    })
}

fn camera() -> Schema {
    (
        json!({
            "timestamp": foxglove_time(),
            "frame_id": {"type": "string"},
            "data": {"type": "string", "contentEncoding": "base64"},
            "format": {"type": "string"},
        }),
        &["timestamp", "frame_id", "data", "format"],
    )
}

fn detections() -> Schema {
    let number = |description: &str| json!({"type": "number", "description": description});
    (
        json!({
            "time_ms": time_ms(),
            "ellipses": {"type": "array", "items": {"type": "object", "properties": {
                "center_x": number("pixels from the left"),
                "center_y": number("pixels from the top"),
                "semi_major": number("pixels"),
                "semi_minor": number("pixels"),
                "theta": number("radians from +x towards +y"),
                "score": number("0 to 1"),
            }}},
        }),
        &["time_ms", "ellipses"],
    )
}

fn annotations() -> Schema {
    let point = json!({"type": "object", "title": "foxglove.Point2", "properties": {
        "x": {"type": "number"}, "y": {"type": "number"},
    }});
    let colour = json!({"type": "object", "title": "foxglove.Color", "properties": {
        "r": {"type": "number"}, "g": {"type": "number"}, "b": {"type": "number"}, "a": {"type": "number"},
    }});
    let list = |items: &Value| json!({"type": "array", "items": items});
    let points = json!({"type": "object", "title": "foxglove.PointsAnnotation", "properties": {
        "timestamp": foxglove_time(),
        "type": {"type": "integer", "description": "2 is a closed line"},
        "points": list(&point),
        "outline_color": colour,
        "outline_colors": list(&colour),
        "fill_color": colour,
        "thickness": {"type": "number"},
    }});
    let any = json!({"type": "object"});
    (
        json!({"circles": list(&any), "points": list(&points), "texts": list(&any)}),
        &["circles", "points", "texts"],
    )
}
