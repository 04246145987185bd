//! What may be wrong with a world.

use thiserror::Error;

/// Why a description was refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WorldError {
    /// A length, place or brightness lies outside its limits or is not finite.
    #[error("{object}: {quantity} is {value}, allowed are {least} to {most}")]
    OutOfRange {
        /// Name of the object.
        object: String,
        /// The field, with its unit.
        quantity: &'static str,
        /// What was given.
        value: f64,
        /// Least value allowed.
        least: f64,
        /// Greatest value allowed.
        most: f64,
    },
    /// An object without a name, or with a very long one.
    #[error("an object's name has {length} bytes, allowed are 1 to {most}")]
    NameLength {
        /// Bytes of the name.
        length: usize,
        /// Most bytes allowed.
        most: usize,
    },
    /// Two objects share a name.
    #[error("the name {name:?} is used twice, give each object its own")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// More objects than a picture can be rendered from in bounded time.
    #[error("the world has {count} objects, allowed are at most {most}")]
    TooManyObjects {
        /// Objects given.
        count: usize,
        /// Most objects allowed.
        most: usize,
    },
    /// No built-in world has this name.
    #[error("there is no built-in world {name:?}, choose one of {known}")]
    UnknownWorld {
        /// The name asked for.
        name: String,
        /// The names there are, separated by commas.
        known: String,
    },
    /// The JSON text is no world.
    #[error("the text is no world description: {source}")]
    Json {
        /// Where and why.
        source: serde_json::Error,
    },
}
