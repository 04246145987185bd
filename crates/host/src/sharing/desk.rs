//! The holder's end: takes in actions of other programs.

use std::fs::{self, Permissions};
use std::io::{ErrorKind, Read, Write};
use std::os::unix::fs::PermissionsExt;
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use super::socket_path;
use super::wire::{Ask, ClaimTold, Lines, Play, ProgressTold, ReportTold, Told, VERSION, line};
use crate::{CancelToken, Error, PauseSwitch, PlayOptions, Policy, Robot, Stage, Terms};

/// How many guests may be there at once.
const GUESTS_MAX: usize = 32;
/// How often a guest's thread looks whether the desk closes.
const LOOK: Duration = Duration::from_millis(100);

/// Plays actions of other programs on a stage, until it is dropped.
///
/// Dropping it ends what its guests have under way, and tells them.
pub struct Desk {
    path: PathBuf,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

struct Shared {
    stage: Stage,
    is_closing: AtomicBool,
    guests: AtomicUsize,
}

impl Desk {
    /// Opens the desk of the line that `robot` holds. None where no other program can reach the robot (no lock
    /// between programs), or the system has no place for the socket.
    ///
    /// # Errors
    /// [`Error::Lock`] when the socket cannot be made.
    pub fn open(robot: &Robot, stage: &Stage) -> Result<Option<Desk>, Error> {
        let Some((folder, key)) = robot.lock_place() else { return Ok(None) };
        let Some(path) = socket_path(folder, key) else {
            tracing::warn!("{}: too long a name for a socket; nobody can join", folder.display());
            return Ok(None);
        };
        let failed = |source| Error::Lock { path: path.display().to_string(), source };
        // Only a holder that died without a word has left one behind: the line is ours.
        match fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(failed(error)),
            _ => {}
        }
        let listener = UnixListener::bind(&path).map_err(failed)?;
        fs::set_permissions(&path, Permissions::from_mode(0o600)).map_err(failed)?;
        stage.share();
        let shared = Arc::new(Shared {
            stage: stage.clone(),
            is_closing: AtomicBool::new(false),
            guests: AtomicUsize::new(0),
        });
        let of_thread = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("rsapien-desk".to_owned())
            .spawn(move || receive(&listener, &of_thread))
            .map_err(failed)?;
        Ok(Some(Desk { path, shared, thread: Some(thread) }))
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        self.shared.is_closing.store(true, Ordering::SeqCst);
        // It waits for a guest: this is the last one.
        let _ = UnixStream::connect(&self.path);
        let _ = fs::remove_file(&self.path);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Takes guests in, each on a thread of its own, until the desk closes.
fn receive(listener: &UnixListener, shared: &Arc<Shared>) {
    std::thread::scope(|scope| {
        for stream in listener.incoming() {
            if shared.is_closing.load(Ordering::SeqCst) {
                return;
            }
            let Ok(stream) = stream else {
                std::thread::sleep(LOOK);
                continue;
            };
            if shared.guests.load(Ordering::SeqCst) >= GUESTS_MAX {
                let text = format!("{GUESTS_MAX} programs are there already");
                tell(&Mutex::new(&stream), &Told::Failed { text, is_refusal: true });
                continue;
            }
            shared.guests.fetch_add(1, Ordering::SeqCst);
            scope.spawn(move || {
                serve(&stream, shared);
                shared.guests.fetch_sub(1, Ordering::SeqCst);
            });
        }
    });
}

type Voice<'a> = Mutex<&'a UnixStream>;

/// Says something to the guest. One that does not hear is gone, which its ears find out.
fn tell(voice: &Voice<'_>, told: &Told) {
    let mut stream = *voice.lock().unwrap_or_else(PoisonError::into_inner);
    let _ = stream.write_all(&line(told));
}

/// Serves one guest until it goes or the desk closes.
fn serve(stream: &UnixStream, shared: &Shared) {
    // One that reads nothing must not keep its action, or the desk, from ending.
    let is_set = stream.set_read_timeout(Some(LOOK)).is_ok()
        && stream.set_write_timeout(Some(Duration::from_secs(2))).is_ok();
    if !is_set {
        return;
    }
    let voice = Mutex::new(stream);
    let (cancel, pause) = (CancelToken::new(), PauseSwitch::new());
    std::thread::scope(|scope| {
        let mut playing: Option<std::thread::ScopedJoinHandle<'_, ()>> = None;
        let (voice, cancel, pause) = (&voice, &cancel, &pause);
        hear(stream, shared, |ask| match ask {
            Ask::Pause => pause.pause(),
            Ask::Resume => pause.resume(),
            Ask::Cancel => cancel.cancel(),
            Ask::Claims => {
                let (playing, waiting) = shared.stage.claims();
                let (playing, waiting) = (ClaimTold::of(&playing), ClaimTold::of(&waiting));
                tell(voice, &Told::Claims { playing, waiting });
            }
            Ask::Play(_) if playing.as_ref().is_some_and(|thread| !thread.is_finished()) => {
                let text = "one action after the other: the last one has not ended".to_owned();
                tell(voice, &Told::Failed { text, is_refusal: true });
            }
            Ask::Play(play) => {
                playing = Some(scope.spawn(move || play_for(*play, voice, shared, cancel, pause)));
            }
        });
        // It went, or the desk closes: its action goes with it.
        cancel.cancel();
    });
}

/// Hands on what the guest asks, until it goes or the desk closes.
fn hear(mut stream: &UnixStream, shared: &Shared, mut on_ask: impl FnMut(Ask)) {
    let mut lines = Lines::default();
    let mut buffer = [0; 4096];
    while !shared.is_closing.load(Ordering::SeqCst) {
        match stream.read(&mut buffer) {
            Ok(0) => return,
            Ok(count) => {
                if !lines.take(buffer.get(..count).unwrap_or_default()) {
                    return;
                }
                while let Some(line) = lines.next() {
                    match serde_json::from_slice(&line) {
                        Ok(ask) => on_ask(ask),
                        Err(error) => {
                            tracing::warn!(%error, "a guest was not understood");
                            return;
                        }
                    }
                }
            }
            Err(error) if is_time_out(&error) => {}
            Err(_) => return,
        }
    }
}

/// Whether a read has only waited long enough.
pub(super) fn is_time_out(error: &std::io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted)
}

/// Plays one action and tells its guest.
fn play_for(
    play: Play,
    voice: &Voice<'_>,
    shared: &Shared,
    cancel: &CancelToken,
    pause: &PauseSwitch,
) {
    let refuse =
        |text: &str| tell(voice, &Told::Failed { text: text.to_owned(), is_refusal: true });
    if play.version != VERSION {
        return refuse("the program that holds the line is of another version: use the same one");
    }
    let Some(policy) = Policy::from_name(&play.policy) else {
        return refuse("the program that holds the line does not know this policy");
    };
    let Some(action) = play.action.compiled() else {
        return refuse("the action handed in makes no sense");
    };
    let terms = Terms { policy, guest: Some((play.program, play.pid)) };
    let mut options = PlayOptions {
        cancel: cancel.clone(),
        pause: Some(pause.clone()),
        from_label: play.from_label,
        on_progress: Some(Box::new(|progress| {
            tell(voice, &Told::Progress(ProgressTold::of(progress)));
        })),
        wait_for_rest: play.wait_for_rest,
    };
    let played = shared.stage.play(&action, &terms, &mut options, &mut |admission| {
        tell(voice, &Told::admitted(admission));
    });
    drop(options);
    tell(
        voice,
        &match played {
            Ok(report) => Told::Report(Box::new(ReportTold::of(&report))),
            Err(Error::Claimed { action, by, joints }) => {
                let joints = rsapien_protocol::Joint::ALL
                    .into_iter()
                    .filter(|joint| joints.contains(&joint.name()))
                    .map(rsapien_protocol::Joint::index)
                    .collect();
                Told::Claimed { action, by: ClaimTold::of(&by), joints }
            }
            Err(error) => Told::Failed { text: error.to_string(), is_refusal: error.is_refusal() },
        },
    );
}
