//! From typed errors to what a user reads: what happened, why, and the next thing to do.

use std::error::Error;
use std::fmt;
use std::io;
use std::path::Path;

use rsapien_registry::Findings;
use rsapien_registry::check;
use rsapien_vision::PictureError;

use super::exit::Status;
use super::output::Screen;

/// A command's result: how it ended, or why it could not.
pub(crate) type Result<T> = std::result::Result<T, Failure>;

/// Why a command ended without doing its part, ready to be shown.
#[derive(Debug)]
pub(crate) struct Failure {
    message: String,
    hint: Option<String>,
    cause: Option<Cause>,
    status: Status,
    closed_pipe: bool,
    /// What the checker found, and the name of the text it was found in.
    findings: Option<Box<(Findings, String)>>,
}

/// One link of the chain of reasons below a message.
#[derive(Debug)]
struct Cause {
    message: String,
    cause: Option<Box<Cause>>,
}

impl Failure {
    /// A failure of our own or of the user's: exit status 2.
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            hint: None,
            cause: None,
            status: Status::Failed,
            closed_pipe: false,
            findings: None,
        }
    }

    /// A text of actions that the checker refuses; it is shown with its places, as of `file_name`.
    pub(crate) fn findings(findings: Findings, file_name: &str) -> Self {
        let message = match findings.errors().count() {
            1 => "the checker refuses it".to_owned(),
            count => format!("the checker refuses it ({count} errors)"),
        };
        let findings = Some(Box::new((findings, file_name.to_owned())));
        Self { findings, ..Self::new(message) }
    }

    /// The answer "no": exit status 1.
    pub(crate) fn refused(message: impl Into<String>) -> Self {
        Self { status: Status::Refused, ..Self::new(message) }
    }

    /// The run was ended by the user.
    pub(crate) fn interrupted() -> Self {
        Self {
            status: Status::Interrupted,
            ..Self::new("interrupted; the motors were told to stop")
        }
    }

    /// The user ended a run over pictures, `done` of `total` of which were finished.
    pub(crate) fn interrupted_after(done: usize, total: usize) -> Self {
        Self {
            status: Status::Interrupted,
            ..Self::new(format!("interrupted; {done} of {total} pictures were finished"))
        }
    }

    /// An error and everything beneath it.
    pub(crate) fn from_error(error: &(dyn Error + 'static)) -> Self {
        Self {
            cause: Cause::chain(error.source(), &error.to_string()),
            ..Self::new(error.to_string())
        }
    }

    /// A file that could not be read or written.
    pub(crate) fn file(action: &str, path: &Path, error: &io::Error) -> Self {
        let failure = Self::new(format!("cannot {action} {}: {error}", path.display()));
        match error.kind() {
            io::ErrorKind::NotFound if action == "read" => {
                failure.hint("check the name; it is looked for from the current folder")
            }
            io::ErrorKind::NotFound if action == "write" => {
                failure.hint("its folder is not there: make it first, or choose another")
            }
            io::ErrorKind::PermissionDenied => failure.hint("check who may use it with ls -l"),
            _ => failure,
        }
    }

    /// The same with the next thing to do.
    #[must_use]
    pub(crate) fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// The same with this exit status.
    #[must_use]
    pub(crate) fn status(mut self, status: Status) -> Self {
        self.status = status;
        self
    }

    /// The same told of `place`, such as the number of a step.
    #[must_use]
    pub(crate) fn within(mut self, place: &str) -> Self {
        self.message = format!("{place}: {}", self.message);
        self
    }

    /// The exit status it stands for.
    pub(crate) const fn exit_status(&self) -> Status {
        self.status
    }

    /// Whether the reader of our output went away, which is no error of ours.
    pub(crate) const fn is_closed_pipe(&self) -> bool {
        self.closed_pipe
    }
}

impl Cause {
    /// The chain from `source` on, without those that only repeat what stands above.
    fn chain(source: Option<&(dyn Error + 'static)>, above: &str) -> Option<Self> {
        let source = source?;
        let message = source.to_string();
        if above.contains(&message) {
            return Self::chain(source.source(), above);
        }
        Some(Self { cause: Self::chain(source.source(), &message).map(Box::new), message })
    }
}

/// Only for what is written to the standard output: files go through [`Failure::file`].
impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        let closed_pipe = error.kind() == io::ErrorKind::BrokenPipe;
        Self { closed_pipe, ..Self::new(format!("cannot write the output: {error}")) }
    }
}

impl From<serde_json::Error> for Failure {
    fn from(error: serde_json::Error) -> Self {
        // What serde_json wraps of a closed pipe is still a closed pipe.
        io::Error::from(error).into()
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.message)
    }
}

impl Error for Failure {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.cause.as_ref().map(|cause| cause as &(dyn Error + 'static))
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.message)
    }
}

impl Error for Cause {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.cause.as_ref().map(|cause| cause.as_ref() as &(dyn Error + 'static))
    }
}

impl miette::Diagnostic for Failure {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.hint.as_ref().map(|hint| Box::new(hint) as Box<dyn fmt::Display>)
    }
}

/// A picture that could not be read or written; the message names the file.
pub(crate) fn picture(path: &Path, error: &PictureError) -> Failure {
    match error {
        PictureError::File { action, source, .. } => Failure::file(action, path, source),
        PictureError::FileTooLarge { .. } => Failure::from_error(error),
        PictureError::UnknownFormat => {
            Failure::new(format!("{}: {error}", path.display())).hint("convert it to png first")
        }
        _ => Failure::new(format!("{}: {error}", path.display())),
    }
}

/// The failure as text that ends with a new line: drawn for a terminal, plain lines elsewhere.
pub(crate) fn render(failure: &Failure, screen: Screen) -> String {
    if let Some(found) = &failure.findings {
        let (findings, file_name) = &**found;
        return check::render(findings, file_name, screen == Screen::Color) + &plain(failure);
    }
    if screen.is_terminal() {
        let theme = if screen == Screen::Color {
            miette::GraphicalTheme::unicode()
        } else {
            miette::GraphicalTheme::unicode_nocolor()
        };
        let mut text = String::new();
        let handler = miette::GraphicalReportHandler::new_themed(theme).with_width(100);
        if handler.render_report(&mut text, failure).is_ok() {
            return text;
        }
    }
    plain(failure)
}

fn plain(failure: &Failure) -> String {
    let mut text = format!("rsapien: {}\n", failure.message);
    let mut cause = failure.cause.as_ref();
    while let Some(reason) = cause {
        text.push_str("  because: ");
        text.push_str(&reason.message);
        text.push('\n');
        cause = reason.cause.as_deref();
    }
    for line in failure.hint.iter().flat_map(|hint| hint.lines()) {
        text.push_str("  help: ");
        text.push_str(line);
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, thiserror::Error)]
    #[error("cannot open the link")]
    struct Outer(#[source] Inner);

    #[derive(Debug, thiserror::Error)]
    #[error("no such device")]
    struct Inner;

    #[test]
    fn plain_text_tells_what_why_and_what_next() {
        let failure = Failure::from_error(&Outer(Inner)).hint("see rsapien ports");
        assert_eq!(
            render(&failure, Screen::None),
            "rsapien: cannot open the link\n  because: no such device\n  help: see rsapien ports\n"
        );
    }

    #[test]
    fn a_drawn_failure_without_colour_has_no_escape_codes() {
        let failure = Failure::from_error(&Outer(Inner)).hint("see rsapien ports");
        let drawn = render(&failure, Screen::Plain);
        assert!(!drawn.contains('\x1b'), "{drawn}");
        for part in ["cannot open the link", "no such device", "see rsapien ports"] {
            assert!(drawn.contains(part), "{drawn}");
        }
        assert!(render(&failure, Screen::Color).contains('\x1b'));
    }

    #[test]
    fn a_cause_that_repeats_the_message_is_told_once() {
        #[derive(Debug, thiserror::Error)]
        #[error("cannot open the link: no such device")]
        struct Repeats(#[source] Inner);
        assert_eq!(
            render(&Failure::from_error(&Repeats(Inner)), Screen::None),
            "rsapien: cannot open the link: no such device\n"
        );
    }

    #[test]
    fn a_closed_pipe_is_told_apart_also_through_json() {
        struct Closed;
        impl io::Write for Closed {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::ErrorKind::BrokenPipe.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let error = serde_json::to_writer(Closed, &[1]).unwrap_err();
        assert!(Failure::from(error).is_closed_pipe());
        assert!(!Failure::new("else").is_closed_pipe());
    }
}
