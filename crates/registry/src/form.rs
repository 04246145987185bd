//! How a step is written: with keys (TOML, JSON) and in short (command line).

use std::fmt;

use rsapien_protocol::{BumperMask, Primitive};
use serde::de::{SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::action::{ActionStep, TIMES_MAX, pose_of};
use crate::draft_check::{RESERVED_NAME, name_problem};
use crate::problem::Problem;
use crate::suggest::closest;

/// The word that stands for the four bumpers of the feet.
const FEET: &str = "feet";

/// A step as it is written with keys, unchecked.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StepForm {
    #[serde(rename = "do", default, skip_serializing_if = "Option::is_none")]
    pub(crate) primitives: Option<Words>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) pause: Option<i64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) play: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) ms: Option<i64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) until: Option<Words>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) times: Option<i64>,
}

impl StepForm {
    /// The shortest form of a step.
    pub(crate) fn of(step: &ActionStep) -> StepForm {
        let several = |times: u16| (times != 1).then_some(i64::from(times));
        match step {
            ActionStep::Play { action, times } => StepForm {
                play: Some(action.clone()),
                times: several(*times),
                ..StepForm::default()
            },
            ActionStep::Move { pose, duration_ms, ending_bumpers, times } => {
                let ms = Some(i64::from(*duration_ms));
                let common = StepForm {
                    until: (!ending_bumpers.is_empty()).then(|| bumper_words(*ending_bumpers)),
                    times: several(*times),
                    ..StepForm::default()
                };
                if pose.is_empty() {
                    StepForm { pause: ms, ..common }
                } else {
                    let names = pose.primitives().map(|primitive| primitive.to_string()).collect();
                    StepForm { primitives: Some(Words(names)), ms, ..common }
                }
            }
        }
    }

    /// The step that is meant.
    pub(crate) fn read(self) -> Result<ActionStep, Problem> {
        let times = self.times.map_or(Ok(1), times_of)?;
        let ending_bumpers =
            self.until.as_ref().map_or(Ok(BumperMask::NONE), |words| bumpers_of(&words.0))?;
        match (self.primitives, self.pause, self.play) {
            (Some(words), None, None) => {
                let pose = pose_of(&primitives_of(&words.0)?)?;
                let duration_ms = duration_of(self.ms.ok_or(Problem::MissingDuration)?)?;
                Ok(ActionStep::Move { pose, duration_ms, ending_bumpers, times })
            }
            (None, Some(pause), None) => {
                if self.ms.is_some() {
                    return Err(Problem::MisplacedKey { key: "ms", with: "pause" });
                }
                let duration_ms = duration_of(pause)?;
                let pose = rsapien_protocol::Pose::EMPTY;
                Ok(ActionStep::Move { pose, duration_ms, ending_bumpers, times })
            }
            (None, None, Some(action)) => {
                for (key, given) in [("ms", self.ms.is_some()), ("until", self.until.is_some())] {
                    if given {
                        return Err(Problem::MisplacedKey { key, with: "play" });
                    }
                }
                Ok(ActionStep::Play { action, times })
            }
            (primitives, pause, play) => {
                let kinds = [
                    ("do", primitives.is_some()),
                    ("pause", pause.is_some()),
                    ("play", play.is_some()),
                ];
                let found = kinds.into_iter().filter_map(|(key, given)| given.then_some(key));
                Err(Problem::StepKind { found: found.collect() })
            }
        }
    }
}

impl ActionStep {
    /// The step of a short form, as on a command line:
    /// `PRIMITIVE[+PRIMITIVE...][:MS][*TIMES]`, `pause:MS[*TIMES]` or `ACTION[*TIMES]`.
    ///
    /// Without `:MS` primitives last [`ActionStep::DURATION_MS_DEFAULT`]. A single word that is
    /// no primitive's name or number is taken for an action's name.
    ///
    /// # Errors
    /// The [`Problem`] of the text: an unknown primitive, two primitives of one joint, a duration
    /// or a number of repeats that is not allowed, or a text of another form.
    pub fn parse_short(text: &str) -> Result<ActionStep, Problem> {
        let malformed = || Problem::BadShortStep { text: text.to_owned() };
        let number = |digits: &str| digits.trim().parse::<i64>().map_err(|_| malformed());
        let (rest, times) = match text.rsplit_once('*') {
            Some((rest, digits)) => (rest, times_of(number(digits)?)?),
            None => (text, 1),
        };
        let (what, ms) = match rest.rsplit_once(':') {
            Some((what, digits)) => (what.trim(), Some(number(digits)?)),
            None => (rest.trim(), None),
        };
        let words: Vec<String> = what.split('+').map(|word| word.trim().to_owned()).collect();
        let plays_action = words.len() == 1
            && what != RESERVED_NAME
            && ms.is_none()
            && Primitive::parse(what).is_err();
        if what.is_empty() {
            return Err(malformed());
        }
        if plays_action {
            return match name_problem(what) {
                None => Ok(ActionStep::play(what, times)),
                Some(_) => Err(malformed()),
            };
        }
        let pose = if what == RESERVED_NAME {
            if ms.is_none() {
                return Err(malformed());
            }
            rsapien_protocol::Pose::EMPTY
        } else {
            pose_of(&primitives_of(&words)?)?
        };
        let duration_ms = ms.map_or(Ok(ActionStep::DURATION_MS_DEFAULT), duration_of)?;
        Ok(ActionStep::Move { pose, duration_ms, ending_bumpers: BumperMask::NONE, times })
    }
}

/// One word or several, written as one string or as a list; numbers count as words.
#[derive(Debug, Default)]
pub(crate) struct Words(pub(crate) Vec<String>);

impl Serialize for Words {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0.as_slice() {
            [word] => serializer.serialize_str(word),
            words => words.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Words {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Words, D::Error> {
        struct WordsVisitor;
        impl<'de> Visitor<'de> for WordsVisitor {
            type Value = Words;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a name or a list of names")
            }

            fn visit_str<E>(self, word: &str) -> Result<Words, E> {
                Ok(Words(word.split('+').map(str::to_owned).collect()))
            }

            fn visit_i64<E>(self, number: i64) -> Result<Words, E> {
                Ok(Words(vec![number.to_string()]))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Words, A::Error> {
                let mut words = Vec::new();
                while let Some(Words(more)) = list.next_element::<Words>()? {
                    words.extend(more);
                }
                Ok(Words(words))
            }
        }
        deserializer.deserialize_any(WordsVisitor)
    }
}

fn primitives_of(words: &[String]) -> Result<Vec<Primitive>, Problem> {
    if words.is_empty() {
        return Err(Problem::StepKind { found: vec!["an empty do"] });
    }
    words
        .iter()
        .map(|word| {
            Primitive::parse(word).map_err(|_| {
                let names: Vec<String> = Primitive::all().map(|it| it.to_string()).collect();
                let suggestion = closest(word, names.iter().map(String::as_str));
                Problem::UnknownPrimitive { text: word.clone(), suggestion }
            })
        })
        .collect()
}

fn bumpers_of(words: &[String]) -> Result<BumperMask, Problem> {
    let mut bits = 0;
    for word in words {
        bits |= match BumperMask::NAMES.iter().position(|name| name == word) {
            Some(index) => 1 << index,
            None if word == FEET => BumperMask::FEET.bits(),
            None => return Err(Problem::UnknownBumper { text: word.clone() }),
        };
    }
    Ok(BumperMask::from_low_bits(bits))
}

fn bumper_words(bumpers: BumperMask) -> Words {
    if bumpers == BumperMask::FEET {
        Words(vec![FEET.to_owned()])
    } else {
        Words(bumpers.names().map(str::to_owned).collect())
    }
}

fn duration_of(ms: i64) -> Result<u16, Problem> {
    u16::try_from(ms).ok().filter(|ms| *ms > 0).ok_or(Problem::BadDuration { ms })
}

fn times_of(times: i64) -> Result<u16, Problem> {
    let count = u16::try_from(times).ok();
    count.filter(|count| (1..=TIMES_MAX).contains(count)).ok_or(Problem::BadTimes { times })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rsapien_protocol::{Joint, Pose, Position};

    #[test]
    fn short_forms() {
        let pose = Pose::EMPTY
            .with(Joint::RightArm, Some(Position::First))
            .with(Joint::Tilt, Some(Position::First));
        let step = |pose, duration_ms, times| ActionStep::Move {
            pose,
            duration_ms,
            ending_bumpers: BumperMask::NONE,
            times,
        };
        let read = |text| ActionStep::parse_short(text).unwrap();
        assert_eq!(read("right-arm-up+tilt-left:500*3"), step(pose, 500, 3));
        assert_eq!(read("1+13"), step(pose, 1000, 1));
        assert_eq!(read("pause:300"), ActionStep::pause(300));
        assert_eq!(read("wave*2"), ActionStep::play("wave", 2));
    }

    #[test]
    fn short_forms_refused() {
        let refused = |text: &str| ActionStep::parse_short(text).unwrap_err();
        assert_eq!(refused("tilt-left:0"), Problem::BadDuration { ms: 0 });
        assert_eq!(refused("tilt-left:65536"), Problem::BadDuration { ms: 65536 });
        assert_eq!(refused("tilt-left*0"), Problem::BadTimes { times: 0 });
        assert_eq!(
            refused("tilt-lefd:5"),
            Problem::UnknownPrimitive {
                text: "tilt-lefd".into(),
                suggestion: Some("tilt-left".into())
            }
        );
        assert!(matches!(refused("tilt-left+tilt-right"), Problem::OppositePositions { .. }));
        for text in ["", "pause", "pause:", ":5", "tilt-left:x", "*", "wave**2", "Wave", "a b"] {
            assert_eq!(refused(text), Problem::BadShortStep { text: text.into() }, "{text:?}");
        }
    }
}
