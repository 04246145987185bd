//! The short form of a statement, as on a command line.

use rsapien_protocol::{Pose, Primitive};

use super::parse::read_value;
use super::tree::{Quantity, Span, Statement, StatementKind, Value};
use crate::check::{Finding, Rule};
use crate::suggest::closest;

/// The word of the short form that no action may bear as its name.
pub(crate) const RESERVED_NAME: &str = "pause";

const FORM: &str = "a step is PRIMITIVE[+PRIMITIVE...][:MS][*TIMES], pause:MS or ACTION[*TIMES]";

impl Statement {
    /// How long a step lasts where a short form gives no duration: 1000 ms.
    pub const SHORT_DURATION_MS_DEFAULT: u16 = 1000;

    /// The statement of a short form: `PRIMITIVE[+PRIMITIVE...][:MS][*TIMES]`, `pause:MS[*TIMES]` or
    /// `ACTION[*TIMES]`.
    ///
    /// Without `:MS` primitives last [`Statement::SHORT_DURATION_MS_DEFAULT`]. A single word that is
    /// no primitive's name or number is taken for an action's name.
    ///
    /// # Errors
    /// An unknown primitive, two positions of one joint, a duration or a number of repeats that is
    /// not allowed, or a text of another form.
    pub fn parse_short(text: &str) -> Result<Statement, Finding> {
        let malformed = || refused(Rule::Syntax, format!("{text:?} is no step"), FORM);
        let number = |digits: &str| digits.trim().parse::<i64>().map_err(|_| malformed());
        let (rest, times) = match text.rsplit_once('*') {
            Some((rest, digits)) => (rest, times_of(number(digits)?)?),
            None => (text, 1),
        };
        let (what, ms) = match rest.rsplit_once(':') {
            Some((what, digits)) => (what.trim(), Some(number(digits)?)),
            None => (rest.trim(), None),
        };
        let words: Vec<&str> = what.split('+').map(str::trim).collect();
        let is_primitive = Primitive::parse(what).is_ok();
        if what.is_empty() {
            return Err(malformed());
        }
        if words.len() == 1 && what != RESERVED_NAME && ms.is_none() && !is_primitive {
            return if super::is_name(what) {
                Ok(Statement::play(what, times))
            } else {
                Err(malformed())
            };
        }
        let pose = if what == RESERVED_NAME {
            if ms.is_none() {
                return Err(malformed());
            }
            Pose::EMPTY
        } else {
            pose_of(&words)?
        };
        let duration_ms = ms.map_or(Ok(Self::SHORT_DURATION_MS_DEFAULT), duration_of)?;
        let statement = if pose.is_empty() {
            Statement::wait(duration_ms)
        } else {
            Statement::moving(pose, duration_ms)
        };
        if times == 1 {
            return Ok(statement);
        }
        let count = Some(Quantity::count(u32::from(times)));
        Ok(StatementKind::Repeat { count, body: vec![statement] }.into())
    }
}

fn refused(rule: Rule, message: String, help: impl Into<String>) -> Finding {
    Finding::new(rule, Span::default(), message).help(help)
}

fn pose_of(words: &[&str]) -> Result<Pose, Finding> {
    let mut pose = Pose::EMPTY;
    for word in words {
        let primitive = Primitive::parse(word).map_err(|_| unknown_primitive(word))?;
        let joint = primitive.joint();
        if let Some(position) = pose.get(joint) {
            let first = Primitive::new(joint, position);
            let message = if first == primitive {
                format!("{primitive} is given twice in one step")
            } else {
                format!("{first} and {primitive} cannot run together")
            };
            return Err(refused(Rule::JointTwoWays, message, "they move the same joint"));
        }
        pose = pose.with(joint, Some(primitive.position()));
    }
    Ok(pose)
}

fn unknown_primitive(word: &str) -> Finding {
    let names: Vec<String> = Primitive::all().map(|it| it.to_string()).collect();
    let help = closest(word, names.iter().map(String::as_str)).map_or_else(
        || {
            "write a joint and a position, such as right-arm-up, or a number from 1 to 21"
                .to_owned()
        },
        |name| format!("did you mean {name:?}?"),
    );
    refused(Rule::UnknownName, format!("{word:?} is no motion primitive"), help)
}

fn duration_of(ms: i64) -> Result<u16, Finding> {
    u16::try_from(ms).ok().filter(|ms| *ms > 0).ok_or_else(|| {
        let message = format!("a duration of {ms} ms");
        refused(Rule::OutOfRange, message, "a step lasts 1 to 65535 ms")
    })
}

fn times_of(times: i64) -> Result<u16, Finding> {
    let count = u16::try_from(times).ok().filter(|count| (1..=super::TIMES_MAX).contains(count));
    count.ok_or_else(|| {
        let help = format!("a step is repeated 1 to {} times", super::TIMES_MAX);
        refused(Rule::OutOfRange, format!("{times} times"), help)
    })
}

/// The value of an argument on a command line: `3`, `0.8`, `650ms`.
///
/// # Errors
/// What is wrong with it.
pub fn parse_value(text: &str) -> Result<Value, Finding> {
    let unit = text.find(|letter: char| !letter.is_ascii_digit() && letter != '.');
    let (digits, unit) = text.split_at(unit.unwrap_or(text.len()));
    read_value(digits, unit).map_err(|(rule, why)| {
        let help = "times are written as 650ms, 1.5s or 2min, numbers as 3 or 0.8";
        refused(rule, format!("{text:?} {why}"), help)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rsapien_protocol::{Joint, Position};

    #[test]
    fn short_forms() {
        let pose = Pose::EMPTY
            .with(Joint::RightArm, Some(Position::First))
            .with(Joint::Tilt, Some(Position::First));
        let read = |text| Statement::parse_short(text).unwrap();
        let three = StatementKind::Repeat {
            count: Some(Quantity::count(3)),
            body: vec![Statement::moving(pose, 500)],
        };
        assert_eq!(read("right-arm-up+tilt-left:500*3"), three.into());
        assert_eq!(read("1+13"), Statement::moving(pose, 1000));
        assert_eq!(read("pause:300"), Statement::wait(300));
        assert_eq!(read("wave*2"), Statement::play("wave", 2));
    }

    #[test]
    fn short_forms_refused() {
        for (text, rule) in [
            ("tilt-left:0", Rule::OutOfRange),
            ("tilt-left:65536", Rule::OutOfRange),
            ("tilt-left*0", Rule::OutOfRange),
            ("tilt-lefd:5", Rule::UnknownName),
            ("tilt-left+tilt-right", Rule::JointTwoWays),
            ("tilt-left+13", Rule::JointTwoWays),
        ] {
            assert_eq!(Statement::parse_short(text).unwrap_err().rule, rule, "{text}");
        }
        for text in ["", "pause", "pause:", ":5", "tilt-left:x", "*", "wave**2", "Wave", "a b"] {
            assert_eq!(Statement::parse_short(text).unwrap_err().rule, Rule::Syntax, "{text:?}");
        }
        let unknown = Statement::parse_short("tilt-lefd:5").unwrap_err();
        assert_eq!(unknown.help.as_deref(), Some("did you mean \"tilt-left\"?"));
    }

    #[test]
    fn values_of_a_command_line() {
        assert_eq!(parse_value("3").unwrap(), Value::count(3));
        assert_eq!(parse_value("0.85").unwrap(), Value::Thousandths(850));
        assert_eq!(parse_value("1.5s").unwrap(), Value::DurationMs(1500));
        for text in ["", ".", "ms", "3x", "1.2.3", "0.5ms", "1.2345", "99999999999"] {
            assert!(parse_value(text).is_err(), "{text}");
        }
    }
}
