//! The `rsapien` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(rsapien::cli::main(std::env::args_os()))
}
