//! `rsapien snapshot`: what the camera sees.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;

use super::detect::save;
use crate::LinkAddress;
use crate::cli::camera::{Camera, CameraOptions, HeadOptions, Source};
use crate::cli::context::Context;
use crate::cli::diagnostics::Result;
use crate::cli::exit::Status;
use crate::cli::robot::{self, PaceOptions};

/// Save what the camera sees as a PNG picture
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  rsapien snapshot --link virtual --pan 40 --tilt -20 --out ball.png
  rsapien snapshot --link /tmp/robot              a robot of rsapien sim --pty /tmp/robot")]
pub(crate) struct Cmd {
    /// Where to write the picture; an existing file is replaced
    #[arg(short, long, value_name = "FILE", default_value = "snapshot.png")]
    out: PathBuf,

    #[command(flatten)]
    head: HeadOptions,

    #[command(flatten)]
    camera: CameraOptions,
}

impl Cmd {
    pub(crate) fn run(self, context: &Context, out: &mut impl Write) -> Result<Status> {
        let picture = take(context, out, self.camera.camera, self.head)?;
        save(&picture, &self.out)?;
        let answer = serde_json::json!({
            "file": self.out,
            "width": picture.width(),
            "height": picture.height(),
        });
        let text =
            format!("wrote {} ({} x {})", self.out.display(), picture.width(), picture.height());
        context.style.answer(out, &answer, text)?;
        Ok(Status::Done)
    }
}

/// Takes a picture, with the head turned first where that is asked for.
pub(super) fn take(
    context: &Context,
    out: &mut impl Write,
    source: Source,
    to: HeadOptions,
) -> Result<rsapien_vision::Picture> {
    let link = match (&source, &context.link) {
        (Source::Virtual, None) => LinkAddress::Virtual,
        _ => robot::address(context)?,
    };
    let source = source.resolve(&link)?;
    let turns = to.pan.is_some() || to.tilt.is_some();
    if !turns && source != Source::Virtual {
        return Camera::open(source, None)?.take();
    }
    let pace = PaceOptions { fast: link == LinkAddress::Virtual };
    let open = robot::open_at(context, &link, "snapshot", pace)?;
    let head = open.ready_camera(context, out)?;
    if turns {
        let report = head.state().camera_report();
        let now = |centideg: Option<i16>| centideg.map_or(0.0, |value| f64::from(value) / 100.0);
        let pan = to.pan.unwrap_or_else(|| now(report.map(|report| report.pan_centideg)));
        let tilt = to.tilt.unwrap_or_else(|| now(report.map(|report| report.tilt_centideg)));
        open.done(head.look(pan, tilt, 0))?;
    }
    Camera::open(source, Some(&open.robot))?.take()
}
