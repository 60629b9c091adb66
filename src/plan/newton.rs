//! The steps of an optimisation of shares, where the curvature is known.

use nalgebra::{DMatrix, DVector};

use super::allocation::Allocation;

/// A variance V at shares α, in the numbers of samples: it falls as 1/s if all grow by s.
pub(super) struct Look {
    pub(super) variance: f64,
    /// -∂V/∂α_k.
    pub(super) slope: Vec<f64>,
    /// ∂²V/∂α_k ∂α_l.
    pub(super) curvature: DMatrix<f64>,
    /// c_k.
    pub(super) costs: Vec<f64>,
}

/// Rounds, at most.
const ROUNDS: usize = 10;

/// A round that promises less than this part is not begun.
const NOTHING: f64 = 1e-7;

/// A step is halved so often at most.
const HALVINGS: i32 = 12;

/// Minimises V(α) Σ α_k c_k over shares of at least `floor` / K, from `shares`.
///
/// With n = α / Σ α_k c_k the product is V(n), at the cost 1. So each round solves a quadratic programme,
/// the model of V at n under c·n = 1, and goes along its solution as long as V falls. Shares are
/// α = (1 - floor) s + floor / K with s ≥ 0, which makes K techniques of other costs of them. A round that
/// does not succeed tries α_k ← α_k √(m_k / c_k), the step of Neyman and of Kleiss and Pittau, and the
/// first one takes the better of both.
pub(super) fn newton(
    shares: &[f64],
    floor: f64,
    mut look: impl FnMut(&[f64]) -> Option<Look>,
) -> Allocation {
    let k = shares.len();
    let uniform = floor / k.max(1) as f64;
    let alpha = |s: &DVector<f64>| s.map(|s| (1.0 - floor) * s + uniform);
    // In s, with c·s = 1.
    let mut at = |s: &DVector<f64>| {
        let Look { variance, slope, curvature, costs } = look(alpha(s).as_slice())?;
        let mix = |v: DVector<f64>| v.map(|x| (1.0 - floor) * x).add_scalar(uniform * v.sum());
        let costs = mix(DVector::from(costs));
        let total = costs.dot(s);
        let slope = mix(DVector::from(slope));
        let rows = DMatrix::from_columns(
            &curvature.column_iter().map(|c| mix(c.into_owned())).collect::<Vec<_>>(),
        );
        let both = rows.transpose();
        let both = DMatrix::from_columns(
            &both.column_iter().map(|c| mix(c.into_owned())).collect::<Vec<_>>(),
        );
        let j = variance * total;
        // With respect to n = s / total.
        j.is_finite().then(|| (j, slope * total * total, both * total.powi(3), costs, total))
    };
    let mut s = DVector::from_iterator(
        k,
        shares.iter().map(|share| ((share - uniform) / (1.0 - floor)).max(0.0)),
    );
    if !(floor < 1.0) || k < 2 {
        return Allocation { shares: shares.to_vec(), objective: Vec::new() };
    }
    let Some(mut here) = at(&s) else {
        return Allocation { shares: shares.to_vec(), objective: Vec::new() };
    };
    let mut objective = vec![here.0];
    for round in 0..ROUNDS {
        let (j, slope, curvature, costs, total) = &here;
        let n = &s / *total;
        let neyman = {
            let raw = n.zip_zip_map(slope, costs, |n, m, c| n * (m.max(0.0) / c).sqrt());
            let cost = raw.dot(costs);
            if cost > 0.0 { raw / cost - &n } else { DVector::zeros(k) }
        };
        let programme = quadratic(&n, slope, curvature, costs);
        let promise = slope.dot(&programme) - 0.5 * programme.dot(&(curvature * &programme));
        if !(promise > NOTHING * j) && round > 0 {
            break;
        }
        let mut along = |direction: &DVector<f64>, halvings: i32| {
            (0..halvings).find_map(|halving| {
                let next = &n + direction * 0.5_f64.powi(halving);
                let sum = next.sum();
                let next = next.map(|n| (n / sum).max(0.0));
                at(&next).filter(|found| found.0 < *j).map(|found| (next, found))
            })
        };
        let mut found = along(&programme, HALVINGS);
        if round == 0 || found.is_none() {
            let other = along(&neyman, if round == 0 { 1 } else { HALVINGS });
            found = match (found, other) {
                (Some(a), Some(b)) => Some(if b.1.0 < a.1.0 { b } else { a }),
                (a, b) => a.or(b),
            };
        }
        let Some(found) = found else { break };
        (s, here) = found;
        objective.push(here.0);
    }
    Allocation { shares: alpha(&s).as_slice().to_vec(), objective }
}

/// The step d from n with the least -m·d + d·H d / 2 under c·d = 0 and n + d ≥ 0.
///
/// Active sets: the equations of Lagrange for the free numbers, as far as the first that would be
/// negative, which is held at 0 from then on; one that is held is let go if that helps.
fn quadratic(
    n: &DVector<f64>,
    slope: &DVector<f64>,
    curvature: &DMatrix<f64>,
    costs: &DVector<f64>,
) -> DVector<f64> {
    let k = n.len();
    let mut d = DVector::zeros(k);
    let mut free: Vec<bool> = n.iter().map(|n| *n > 0.0).collect();
    // What keeps nearly dependent techniques from steps without end.
    let ridge = 1e-10 * curvature.diagonal().amax().max(f64::MIN_POSITIVE);
    for _ in 0..3 * k + 3 {
        let set: Vec<usize> = (0..k).filter(|i| free[*i]).collect();
        let size = set.len();
        let residual = slope - curvature * &d;
        let mut matrix = DMatrix::zeros(size + 1, size + 1);
        let mut right = DVector::zeros(size + 1);
        let unit = curvature.diagonal().amax().max(f64::MIN_POSITIVE);
        for (row, i) in set.iter().enumerate() {
            for (column, l) in set.iter().enumerate() {
                matrix[(row, column)] = curvature[(*i, *l)] / unit;
            }
            matrix[(row, row)] += ridge / unit;
            matrix[(row, size)] = costs[*i];
            matrix[(size, row)] = costs[*i];
            right[row] = residual[*i] / unit;
        }
        let Some(solution) = matrix.lu().solve(&right) else { break };
        if solution.iter().any(|x| !x.is_finite()) {
            break;
        }
        let multiplier = solution[size] * unit;
        // How far none is negative, and which one would be.
        let (mut far, mut stop) = (1.0, None);
        for (row, i) in set.iter().enumerate() {
            let (room, step) = (n[*i] + d[*i], solution[row]);
            if room + step * far < 0.0 {
                (far, stop) = ((room / -step).max(0.0), Some(*i));
            }
        }
        for (row, i) in set.iter().enumerate() {
            d[*i] += far * solution[row];
        }
        if let Some(i) = stop {
            d[i] = -n[i];
            free[i] = false;
            continue;
        }
        // Who is held, and had better have samples.
        let residual = slope - curvature * &d;
        let gain = |i: &usize| residual[*i] - multiplier * costs[*i];
        let held = (0..k).filter(|i| !free[*i]).max_by(|a, b| gain(a).total_cmp(&gain(b)));
        match held {
            Some(i) if gain(&i) > 1e-12 * slope.amax() => free[i] = true,
            _ => break,
        }
    }
    d
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::{Look, newton, quadratic};

    fn neyman(sigma: &[f64], costs: &[f64], alpha: &[f64]) -> Look {
        let m = |k: i32| {
            let all = alpha.iter().zip(sigma).map(move |(a, s)| s * s / a.powi(k));
            all.collect::<Vec<f64>>()
        };
        let curvature = DMatrix::from_diagonal(&(2.0 * DVector::from(m(3))));
        Look { variance: m(1).iter().sum(), slope: m(2), curvature, costs: costs.to_vec() }
    }

    #[test]
    fn neymans_shares() {
        let (sigma, costs) = ([3.0, 1.0, 0.5], [1.0, 4.0, 0.25]);
        let found = newton(&[1.0 / 3.0; 3], 1e-9, |alpha| Some(neyman(&sigma, &costs, alpha)));
        // α_k ∝ σ_k / √c_k: 3, 1/2, 1.
        for (alpha, expected) in found.shares.iter().zip([3.0 / 4.5, 0.5 / 4.5, 1.0 / 4.5]) {
            assert!((alpha - expected).abs() < 1e-6, "{found:?}");
        }
        assert!(found.objective.windows(2).all(|two| two[1] < two[0]), "{found:?}");
    }

    /// Those that would have less are at the floor, and the others share the rest as they would alone.
    #[test]
    fn shares_at_the_floor() {
        let (sigma, costs) = ([3.0, 1.0, 0.0], [1.0; 3]);
        let found = newton(&[1.0 / 3.0; 3], 0.3, |alpha| Some(neyman(&sigma, &costs, alpha)));
        for (alpha, expected) in found.shares.iter().zip([0.675, 0.225, 0.1]) {
            assert!((alpha - expected).abs() < 1e-5, "{found:?}");
        }
        let whole = newton(&[0.5, 0.5], 1.0, |alpha| Some(neyman(&[1.0, 9.0], &[1.0; 2], alpha)));
        assert_eq!(whole.shares, [0.5, 0.5]);
    }

    #[test]
    fn nothing_to_go_by() {
        let blind = newton(&[0.25; 4], 0.01, |_| None);
        assert_eq!((blind.shares, blind.objective), (vec![0.25; 4], Vec::new()));
        let nan = newton(&[0.5; 2], 0.01, |_| {
            let curvature = DMatrix::from_element(2, 2, f64::NAN);
            Some(Look { variance: 1.0, slope: vec![f64::NAN; 2], curvature, costs: vec![1.0; 2] })
        });
        for share in nan.shares {
            assert!((share - 0.5).abs() < 1e-12);
        }
    }

    /// Minimise |n + d - (0.9, 0.4, -0.3)|² / 2 on the simplex: (0.75, 0.25, 0).
    #[test]
    fn quadratic_programme_at_a_bound() {
        let n = DVector::from(vec![0.2, 0.3, 0.5]);
        let slope = DVector::from(vec![0.9, 0.4, -0.3]) - &n;
        let d = quadratic(&n, &slope, &DMatrix::identity(3, 3), &DVector::from(vec![1.0; 3]));
        for (found, expected) in (n + d).iter().zip([0.75, 0.25, 0.0]) {
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
        // From the bound, where it is let go.
        let n = DVector::from(vec![0.0, 0.5, 0.5]);
        let slope = DVector::from(vec![0.9, 0.4, -0.3]) - &n;
        let d = quadratic(&n, &slope, &DMatrix::identity(3, 3), &DVector::from(vec![1.0; 3]));
        for (found, expected) in (n + d).iter().zip([0.75, 0.25, 0.0]) {
            assert!((found - expected).abs() < 1e-8, "{found} {expected}");
        }
    }
}
