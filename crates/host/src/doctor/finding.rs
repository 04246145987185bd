//! What a step found, and what all of it comes to.

use rsapien_protocol::HelloReport;

use super::LineQuality;

/// How much a finding matters, the least first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The step was not reached, since an earlier one did not get what it needs.
    NotReached,
    /// As it should be.
    Good,
    /// It works, but could be better; the robot counts as healthy.
    Advice,
    /// Something to mend.
    Problem,
}

impl Severity {
    /// The name as programs read it.
    pub const fn name(self) -> &'static str {
        match self {
            Severity::NotReached => "not-reached",
            Severity::Good => "good",
            Severity::Advice => "advice",
            Severity::Problem => "problem",
        }
    }
}

/// What one step found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The step: `ports`, `permission`, and so on.
    pub check: &'static str,
    /// What was found, as programs tell it apart: `no-permission`, `supply-low`, and so on.
    pub code: &'static str,
    /// How much it matters.
    pub severity: Severity,
    /// What was found, in a line.
    pub found: String,
    /// What to do, the first thing first; empty where nothing is to be done.
    pub remedies: Vec<String>,
}

impl Finding {
    fn new(check: &'static str, code: &'static str, severity: Severity, found: String) -> Finding {
        Finding { check, code, severity, found, remedies: Vec::new() }
    }

    pub(super) fn good(
        check: &'static str,
        code: &'static str,
        found: impl Into<String>,
    ) -> Finding {
        Finding::new(check, code, Severity::Good, found.into())
    }

    pub(super) fn advice(
        check: &'static str,
        code: &'static str,
        found: impl Into<String>,
    ) -> Finding {
        Finding::new(check, code, Severity::Advice, found.into())
    }

    pub(super) fn problem(
        check: &'static str,
        code: &'static str,
        found: impl Into<String>,
    ) -> Finding {
        Finding::new(check, code, Severity::Problem, found.into())
    }

    pub(super) fn not_reached(check: &'static str) -> Finding {
        let found = "not reached: an earlier step did not get so far".to_owned();
        Finding::new(check, "not-reached", Severity::NotReached, found)
    }

    /// The same with one more thing to do.
    #[must_use]
    pub(super) fn remedy(mut self, remedy: impl Into<String>) -> Finding {
        self.remedies.push(remedy.into());
        self
    }
}

/// What all findings come to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// One line: healthy, or what to mend first.
    pub text: String,
    /// The next thing to do.
    pub next: String,
}

/// The outcome of an examination.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagnosis {
    /// The link that the robot answered on.
    pub link: Option<String>,
    /// How the motion controller answered HELLO.
    pub motion: Option<HelloReport>,
    /// How the camera controller answered HELLO.
    pub camera: Option<HelloReport>,
    /// How well packages went to and fro, if that was measured.
    pub line: Option<LineQuality>,
    /// What each step found, in the order of the steps.
    pub findings: Vec<Finding>,
}

impl Diagnosis {
    /// Whether a robot answered and nothing is to be mended.
    pub fn is_healthy(&self) -> bool {
        self.motion.is_some() && self.problems().next().is_none()
    }

    fn problems(&self) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(|finding| finding.severity == Severity::Problem)
    }

    /// The one verdict. Where several things are to be mended, the step that comes first names the one to begin with:
    /// what comes later often follows from it.
    pub fn verdict(&self) -> Verdict {
        let Some(first) = self.problems().next() else {
            let advice = self.findings.iter().any(|found| found.severity == Severity::Advice);
            return match &self.link {
                Some(link) if self.is_healthy() => Verdict {
                    text: format!("the robot on {link} is healthy"),
                    next: if advice {
                        "what is advised above can wait; put the robot where it can move, then: rsapien init".to_owned()
                    } else {
                        "put the robot where it can move, then: rsapien init".to_owned()
                    },
                },
                _ => Verdict {
                    text: "no robot was found".to_owned(),
                    next: "name its port: rsapien doctor --link /dev/ttyUSB0".to_owned(),
                },
            };
        };
        let text = match self.problems().count() {
            1 => format!("one thing is to be mended: {}", first.found),
            count => format!("{count} things are to be mended, first: {}", first.found),
        };
        let next = first.remedies.first().cloned();
        Verdict { text, next: next.unwrap_or_else(|| "mend it, then: rsapien doctor".to_owned()) }
    }
}
