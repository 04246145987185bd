//! The `rsapien` command (feature `cli`), as a function, so that the Python wheel carries the same one.
//!
//! Each subcommand is a file in `cmd`: a parser whose docs are its help, and `run`. Nothing but this module prints,
//! ends the process or reads the environment.

mod camera;
mod cmd;
mod config;
mod context;
mod diagnostics;
mod exit;
mod firmware;
mod install;
mod limits;
mod output;
mod performance;
mod progress;
mod recording;
mod registry;
mod robot;
mod signal;
mod view;
mod world;

use std::ffi::OsString;
use std::io::Write;

use clap::Parser;

use self::context::{Context, GlobalOptions, start_tracing};
use self::diagnostics::Failure;
use self::exit::Status;
use self::output::Screen;

/// A toy humanoid as a laboratory robot: move it, watch it, see with it, or do all that with a virtual one.
#[derive(Debug, Parser)]
#[command(
    name = "rsapien",
    version,
    after_help = EXAMPLES,
    after_long_help = long_ending(),
    arg_required_else_help = true,
    subcommand_required = true,
    max_term_width = 100
)]
struct Arguments {
    #[command(flatten)]
    options: GlobalOptions,
    #[command(subcommand)]
    command: cmd::Command,
}

/// The end of `rsapien -h`.
const EXAMPLES: &str = "\
First steps:
  rsapien demo                            the whole system, on the virtual robot
  rsapien --link virtual play wave        an action on the virtual robot
  rsapien detect photograph.png           the ellipses in a picture
  rsapien ports                           which robots there are";

/// The end of `rsapien --help`.
fn long_ending() -> String {
    format!("{EXAMPLES}\n\n{}", exit::HELP)
}

/// Runs the command with these arguments, the program's name first, and gives the exit status.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help that nobody reads to its end is no failure.
            let _ = error.print();
            return if error.use_stderr() { Status::Failed.code() } else { Status::Done.code() };
        }
    };
    let verbose = arguments.options.verbose;
    start_tracing(verbose);
    // A mistake in a file must not keep the motors running, nor keep the file from being looked at.
    let keeps_going = arguments.command.is_stop();
    let context = match Context::new(arguments.options, keeps_going) {
        Ok(context) => context,
        Err(failure) => return tell(&failure, Screen::None),
    };
    let mut out = std::io::stdout().lock();
    let result = arguments.command.run(&context, &mut out).and_then(|status| {
        out.flush()?;
        Ok(status)
    });
    let status = match signal::finish().and(result) {
        Ok(status) => status,
        Err(failure) if failure.is_closed_pipe() => Status::Done,
        Err(failure) => return tell(&failure, context.style.error),
    };
    status.code()
}

/// Tells a failure, and gives its exit status.
fn tell(failure: &Failure, screen: Screen) -> u8 {
    let text = diagnostics::render(failure, screen);
    // When even the standard error is gone, the status still tells.
    let _ = std::io::stderr().write_all(text.as_bytes());
    failure.exit_status().code()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_parsers_are_consistent_and_every_command_shows_an_example() {
        Arguments::command().debug_assert();
        let mut command = Arguments::command();
        command.build();
        let mut waiting: Vec<(String, clap::Command)> = vec![("rsapien".to_owned(), command)];
        while let Some((name, mut command)) = waiting.pop() {
            let help = command.render_long_help().to_string();
            let examples = help.split_once("Example").or(help.split_once("First steps:"));
            // Arguments of the command above may stand between the words.
            let is_of_it = |line: &str| {
                let mut words = line.split_whitespace();
                name.split(' ').all(|word| words.any(|it| it == word))
            };
            let shows = examples.is_some_and(|(_, examples)| examples.lines().any(is_of_it));
            assert!(shows, "{name} shows no example:\n{help}");
            let below = command.get_subcommands().filter(|below| below.get_name() != "help");
            waiting.extend(below.map(|it| (format!("{name} {}", it.get_name()), it.clone())));
        }
    }
}
