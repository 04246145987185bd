//! The rules that actions are checked by.

/// How grave a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The action cannot be stored or played.
    Error,
    /// The action can be played; it may not do what its writer wants.
    Warning,
}

impl Severity {
    /// `error` or `warning`.
    pub const fn name(self) -> &'static str {
        match self {
            Severity::Error => "error",
            Severity::Warning => "warning",
        }
    }
}

macro_rules! rules {
    ($($(#[$doc:meta])* $rule:ident = $name:literal, $severity:ident, $silenceable:literal;)*) => {
        /// A rule. `docs/rules.md` tells each with an example that triggers it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Rule {
            $($(#[$doc])* $rule,)*
        }

        impl Rule {
            /// Every rule.
            pub const ALL: &'static [Rule] = &[$(Rule::$rule),*];

            /// The name that messages and `allow` use.
            pub const fn name(self) -> &'static str {
                match self { $(Rule::$rule => $name),* }
            }

            /// How grave it is when the rule is broken.
            pub const fn severity(self) -> Severity {
                match self { $(Rule::$rule => Severity::$severity),* }
            }

            /// Whether an action may silence it with `allow`.
            pub const fn is_silenceable(self) -> bool {
                match self { $(Rule::$rule => $silenceable),* }
            }
        }
    };
}

rules! {
    /// The text cannot be read.
    Syntax = "syntax", Error, false;
    /// A primitive, bumper, action, parameter or rule that does not exist.
    UnknownName = "unknown-name", Error, false;
    /// A name that cannot be one.
    BadName = "bad-name", Error, false;
    /// Two actions, parameters, labels or tags of one name.
    DefinedTwice = "defined-twice", Error, false;
    /// A joint is sent to two positions at once, in one step or in two tracks.
    JointTwoWays = "joint-two-ways", Error, false;
    /// Actions play each other in a circle.
    Circle = "circle", Error, false;
    /// A repeat that never ends.
    EndlessRepeat = "endless-repeat", Error, false;
    /// A duration, number, length or size outside its range.
    OutOfRange = "out-of-range", Error, false;
    /// A time where a number is needed, or the other way round.
    WrongKind = "wrong-kind", Error, false;
    /// A statement where it has no meaning.
    Misplaced = "misplaced", Error, false;
    /// An action, block or track without steps.
    Empty = "empty", Error, false;
    /// A joint is sent on before it can have arrived.
    TooShort = "too-short", Error, true;
    /// Legs that do not move symmetrically over a walking cycle.
    LegsNotSymmetrical = "legs-not-symmetrical", Warning, true;
    /// The weight comes onto a leg that is still moving.
    TrunkAgainstLegs = "trunk-against-legs", Warning, true;
    /// A closed hand at the side meets the trunk or the leg.
    ArmsMeetTrunk = "arms-meet-trunk", Warning, true;
    /// The action is longer than the dead-man allows without the PC.
    NeedsThePc = "needs-the-pc", Warning, true;
    /// A motor is driven against an end stop for long.
    AgainstEndStop = "against-end-stop", Warning, true;
    /// The motors take much of what the batteries hold.
    DrainsBatteries = "drains-batteries", Warning, true;
    /// A rule is silenced that has nothing to say here.
    NeedlessAllow = "needless-allow", Warning, false;
}

impl Rule {
    /// The rule of a name.
    pub fn from_name(name: &str) -> Option<Rule> {
        Rule::ALL.iter().copied().find(|rule| rule.name() == name)
    }
}

impl std::fmt::Display for Rule {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.name())
    }
}
