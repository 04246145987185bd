//! Who plays whom: circles found, sizes bounded, before anything is expanded.

use std::collections::BTreeMap;

use crate::action::{ActionDraft, ActionStep};
use crate::compile::{COMPILED_STEPS_MAX, DURATION_MS_MAX, NESTING_MAX};
use crate::problem::{Finding, Problem};

/// How much an action makes when compiled. Saturates instead of overflowing: whatever saturates is
/// far beyond every bound.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) steps: u64,
    pub(crate) duration_ms: u64,
    /// How many actions lie within each other, itself included.
    pub(crate) depth: u32,
}

impl Size {
    pub(crate) fn add_repeated(&mut self, part: Size, times: u16) {
        let times = u64::from(times);
        self.steps = self.steps.saturating_add(part.steps.saturating_mul(times));
        self.duration_ms = self.duration_ms.saturating_add(part.duration_ms.saturating_mul(times));
    }

    /// The bound it breaks, if any.
    pub(crate) fn problem(self) -> Option<Problem> {
        if self.depth > NESTING_MAX {
            Some(Problem::TooDeep { depth: self.depth })
        } else if self.steps > COMPILED_STEPS_MAX {
            Some(Problem::TooManyCompiledSteps { count: self.steps })
        } else if self.duration_ms > DURATION_MS_MAX {
            Some(Problem::TooLong { duration_ms: self.duration_ms })
        } else {
            None
        }
    }
}

/// An action reduced to what its size depends on.
#[derive(Clone, Debug, Default)]
pub(crate) struct Node {
    pub(crate) name: String,
    /// The steps that move joints.
    pub(crate) own: Size,
    /// The nodes it plays, how often, and in which of its steps (from 1; 0 where not known).
    pub(crate) plays: Vec<Play>,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Play {
    pub(crate) node: usize,
    pub(crate) times: u16,
    pub(crate) step: usize,
}

/// Actions by index, each playing others by index.
#[derive(Clone, Debug, Default)]
pub(crate) struct Graph {
    pub(crate) nodes: Vec<Node>,
}

impl Graph {
    /// The graph of `drafts` alone, in their order, with the size of moving steps as `own` says,
    /// or what they play that is not among them.
    pub(crate) fn of_drafts(
        drafts: &[&ActionDraft],
        own: impl Fn(&ActionDraft) -> Size,
    ) -> Result<Graph, Finding> {
        let indices: BTreeMap<&str, usize> =
            (0..).zip(drafts).map(|(index, draft)| (draft.name.as_str(), index)).collect();
        let mut nodes = Vec::with_capacity(drafts.len());
        for draft in drafts {
            let mut plays = Vec::new();
            for (number, step) in (1..).zip(&draft.steps) {
                let ActionStep::Play { action, times } = step else { continue };
                let Some(&node) = indices.get(action.as_str()) else {
                    let problem = Problem::UnknownAction { name: action.clone(), suggestion: None };
                    return Err(Finding::of(&draft.name, Some(number), problem));
                };
                plays.push(Play { node, times: *times, step: number });
            }
            nodes.push(Node { name: draft.name.clone(), own: own(draft), plays });
        }
        Ok(Graph { nodes })
    }

    /// The size of every node that can be reached from `roots`; others keep size zero.
    ///
    /// # Errors
    /// The first circle met, going in the order of `roots` and of steps.
    pub(crate) fn measure(&self, roots: &[usize]) -> Result<Vec<Size>, Finding> {
        #[derive(Clone, Copy, PartialEq)]
        enum Mark {
            New,
            Open,
            Done,
        }
        let mut sizes = vec![Size::default(); self.nodes.len()];
        let mut marks = vec![Mark::New; self.nodes.len()];
        // An own stack of (node, edges already followed): depth is not bounded before it is known.
        let mut open: Vec<(usize, usize)> = Vec::new();
        for &root in roots {
            if marks.get(root) == Some(&Mark::New) {
                open.push((root, 0));
            }
            while let Some((index, followed)) = open.last_mut() {
                let index = *index;
                marks[index] = Mark::Open;
                let node = &self.nodes[index];
                if let Some(play) = node.plays.get(*followed) {
                    *followed += 1;
                    match marks[play.node] {
                        Mark::New => open.push((play.node, 0)),
                        Mark::Done => {}
                        Mark::Open => return Err(self.circle(&open, play.node)),
                    }
                } else {
                    let mut size = Size { depth: 1, ..node.own };
                    for play in &node.plays {
                        let part = sizes[play.node];
                        size.add_repeated(part, play.times);
                        size.depth = size.depth.max(part.depth.saturating_add(1));
                    }
                    sizes[index] = size;
                    marks[index] = Mark::Done;
                    open.pop();
                }
            }
        }
        Ok(sizes)
    }

    /// Whatever breaks a bound among `sizes`, but not what breaks it only because a part does.
    pub(crate) fn beyond_bounds(&self, sizes: &[Size]) -> Vec<Finding> {
        let broken = |index: usize| sizes.get(index).and_then(|size| size.problem());
        let nodes = self.nodes.iter().enumerate();
        nodes
            .filter(|(_, node)| !node.plays.iter().any(|play| broken(play.node).is_some()))
            .filter_map(|(index, node)| Some(Finding::of(&node.name, None, broken(index)?)))
            .collect()
    }

    fn circle(&self, open: &[(usize, usize)], again: usize) -> Finding {
        let from = open.iter().position(|(index, _)| *index == again).unwrap_or(0);
        let circle = open.get(from..).unwrap_or_default();
        let name = |index: usize| self.nodes[index].name.clone();
        let mut path: Vec<String> = circle.iter().map(|(index, _)| name(*index)).collect();
        path.push(name(again));
        let step = circle.first().and_then(|(index, followed)| {
            self.nodes[*index].plays.get(followed.saturating_sub(1)).map(|play| play.step)
        });
        let step = step.filter(|step| *step > 0);
        Finding::of(&name(again), step, Problem::Cycle { path })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graph(edges: &[(usize, usize, u16)], count: usize) -> Graph {
        let own = Size { steps: 1, duration_ms: 10, depth: 0 };
        let mut nodes: Vec<Node> = (0..count)
            .map(|index| Node { name: format!("n{index}"), own, plays: Vec::new() })
            .collect();
        for &(from, node, times) in edges {
            let step = nodes[from].plays.len() + 1;
            nodes[from].plays.push(Play { node, times, step });
        }
        Graph { nodes }
    }

    #[test]
    fn a_circle_is_told_with_its_path_and_the_step_that_enters_it() {
        let graph = graph(&[(0, 3, 1), (0, 1, 1), (1, 2, 1), (2, 1, 1)], 4);
        let finding = graph.measure(&[0]).unwrap_err();
        assert_eq!(
            finding.problem,
            Problem::Cycle { path: ["n1", "n2", "n1"].map(Into::into).into() }
        );
        assert_eq!((finding.action.as_deref(), finding.step), (Some("n1"), Some(1)));
        assert!(graph.measure(&[3]).is_ok());
    }

    #[test]
    fn a_diamond_is_no_circle() {
        let graph = graph(&[(0, 1, 2), (0, 2, 3), (1, 3, 5), (2, 3, 7)], 4);
        let sizes = graph.measure(&[0]).unwrap();
        // 1 + 2 * (1 + 5) + 3 * (1 + 7)
        assert_eq!(sizes[0], Size { steps: 37, duration_ms: 370, depth: 3 });
    }

    #[test]
    fn a_chain_of_repeats_neither_overflows_nor_takes_long() {
        let count = 100_000;
        let edges: Vec<_> = (1..count).map(|index| (index - 1, index, 1000)).collect();
        let graph = graph(&edges, count);
        let sizes = graph.measure(&[0]).unwrap();
        assert_eq!(sizes[0].steps, u64::MAX);
        assert_eq!(sizes[0].depth, 100_000);
        // Only the lowest that break a bound are told: n99998 makes 1001 steps, n99997 a million.
        let findings = graph.beyond_bounds(&sizes);
        assert_eq!(findings.len(), 1);
        assert_eq!(findings[0].action.as_deref(), Some("n99997"));
    }
}
