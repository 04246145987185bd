use super::*;

/// Decimal logarithm of the probability of at least `k` of `n` at `p` each, summed.
fn exact_log10_tail(n: u32, k: u32, p: f64) -> f64 {
    let ln_factorial = |n: u32| (1..=n).map(|i| f64::from(i).ln()).sum::<f64>();
    let ln_term = |i: u32| {
        ln_factorial(n) - ln_factorial(i) - ln_factorial(n - i)
            + f64::from(i) * p.ln()
            + f64::from(n - i) * (1.0 - p).ln()
    };
    let terms: Vec<f64> = (k..=n).map(ln_term).collect();
    let greatest = terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = terms.iter().map(|term| (term - greatest).exp()).sum();
    (greatest + sum.ln()) / std::f64::consts::LN_10
}

#[test]
fn the_bound_is_never_below_the_tail_and_not_far_above() {
    for n in [1, 2, 7, 40, 160] {
        for p in [0.01, 0.1, 0.35, 0.5] {
            for k in 0..=n {
                let bound = log10_tail(f64::from(n), f64::from(k), p);
                let exact = exact_log10_tail(n, k, p);
                assert!(bound >= exact - 1e-6, "{k} of {n} at {p}: {bound} below {exact}");
                assert!(bound <= 0.0);
                // Chernoff's bound is loose by about the square root of the count.
                assert!(bound - exact < 2.0, "{k} of {n} at {p}: {bound} above {exact}");
            }
        }
    }
}

#[test]
fn nothing_to_look_at_means_nothing() {
    assert_eq!(log10_tail(0.0, 0.0, 0.1).to_bits(), 0.0_f64.to_bits());
    assert!(log10_tail(1e6, 1e6, 0.01).is_finite());
    assert!(log10_tail(10.0, 10.000_001, 0.5).is_finite());
}
