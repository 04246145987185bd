//! Values of times and numbers, and whether they are in range.

use std::collections::BTreeMap;

use crate::check::{Finding, Rule};
use crate::expand::{SPEED_MAX, SPEED_MIN};
use crate::language::{
    ActionDraft, Quantity, Span, TIMES_MAX, Value, WAIT_LIMIT_MS_MAX, Word, value_text,
};
use crate::suggest::closest;

/// Values of parameters by their names.
pub(crate) type Values = BTreeMap<String, Value>;

/// What a quantity is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// The duration of a step.
    Duration,
    /// The limit of a wait for a bumper.
    Limit,
    /// A number of repeats.
    Count,
    /// A factor of speed, in thousandths.
    Speed,
}

/// The defaults of the parameters of an action.
pub(crate) fn default_values(draft: &ActionDraft) -> Values {
    let parameters = draft.parameters.iter();
    parameters.map(|parameter| (parameter.name.text.clone(), parameter.default)).collect()
}

/// Puts the value of an argument in place of the default.
pub(crate) fn set_argument(
    draft: &ActionDraft,
    values: &mut Values,
    name: &str,
    value: Value,
    span: Span,
) -> Result<(), Finding> {
    let action = &draft.name.text;
    let Some(default) = draft.parameters.iter().find(|parameter| parameter.name.text == name)
    else {
        let names: Vec<&str> =
            draft.parameters.iter().map(|parameter| parameter.name.text.as_str()).collect();
        let help = match (closest(name, names.iter().copied()), names.as_slice()) {
            (Some(meant), _) => format!("did you mean `{meant}`?"),
            (None, []) => format!("`{action}` has no parameters"),
            (None, names) => format!("its parameters are {}", names.join(", ")),
        };
        let message = format!("the action `{action}` has no parameter `{name}`");
        return Err(Finding::new(Rule::UnknownName, span, message).help(help));
    };
    if std::mem::discriminant(&default.default) != std::mem::discriminant(&value) {
        let default = value_text(default.default);
        let message = format!("`{name}` cannot be {}", value_text(value));
        let help = format!("it is of the kind of its default, `{default}`");
        return Err(Finding::new(Rule::WrongKind, span, message).help(help));
    }
    values.insert(name.to_owned(), value);
    Ok(())
}

/// The value of a quantity.
pub(crate) fn value_of(quantity: &Quantity, values: &Values) -> Result<Value, Finding> {
    match quantity {
        Quantity::Value(value, _) => Ok(*value),
        Quantity::Parameter(name) => {
            values.get(&name.text).copied().ok_or_else(|| unknown_parameter(name, values))
        }
    }
}

fn unknown_parameter(name: &Word, values: &Values) -> Finding {
    let names = || values.keys().map(String::as_str);
    let help = match closest(&name.text, names()) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None if values.is_empty() => {
            format!("the action has no parameters; give it one: `action NAME({} = ...)`", name.text)
        }
        None => format!("its parameters are {}", names().collect::<Vec<_>>().join(", ")),
    };
    let message = format!("there is no parameter `{}`", name.text);
    Finding::new(Rule::UnknownName, name.span, message).help(help)
}

/// The value of a quantity for what is wanted: milliseconds, a count, or thousandths.
pub(crate) fn resolve(
    quantity: &Quantity,
    wanted: Wanted,
    values: &Values,
) -> Result<u32, Finding> {
    let value = value_of(quantity, values)?;
    let span = quantity.span();
    let wrong_kind =
        |message: String, help: &str| Err(Finding::new(Rule::WrongKind, span, message).help(help));
    let written = value_text(value);
    let number = match (wanted, value) {
        (Wanted::Duration | Wanted::Limit, Value::DurationMs(ms)) => ms,
        (Wanted::Duration | Wanted::Limit, Value::Thousandths(_)) => {
            let message = format!("`{written}` is a number, and a time is needed");
            let help = format!("write a time with its unit, such as `{written}s` or `650ms`");
            return wrong_kind(message, &help);
        }
        (Wanted::Count | Wanted::Speed, Value::DurationMs(_)) => {
            let message = format!("`{written}` is a time, and a number is needed");
            return wrong_kind(message, "write a number without a unit, such as `3`");
        }
        (Wanted::Speed, Value::Thousandths(thousandths)) => thousandths,
        (Wanted::Count, Value::Thousandths(thousandths)) => {
            if thousandths % 1000 != 0 {
                let message = format!("`{written}` is no whole number");
                return wrong_kind(message, "repeats are counted in whole numbers");
            }
            thousandths / 1000
        }
    };
    let (is_in_range, what) = match wanted {
        Wanted::Duration => {
            ((1..=u32::from(u16::MAX)).contains(&number), "a step lasts 1ms to 65535ms".to_owned())
        }
        Wanted::Limit => {
            let range =
                format!("a wait for a bumper lasts 1ms to {}min", WAIT_LIMIT_MS_MAX / 60_000);
            ((1..=WAIT_LIMIT_MS_MAX).contains(&number), range)
        }
        Wanted::Count => (
            (1..=u32::from(TIMES_MAX)).contains(&number),
            format!("something is repeated 1 to {TIMES_MAX} times"),
        ),
        Wanted::Speed => (
            (SPEED_MIN..=SPEED_MAX).contains(&(f64::from(number) / 1000.0)),
            format!("a speed is {SPEED_MIN} to {SPEED_MAX}, 1 being as written"),
        ),
    };
    if is_in_range {
        return Ok(number);
    }
    let named = match quantity {
        Quantity::Value(..) => format!("`{written}` is out of range"),
        Quantity::Parameter(name) => {
            format!("`{}`, which is {written}, is out of range", name.text)
        }
    };
    Err(Finding::new(Rule::OutOfRange, span, named).help(what))
}
