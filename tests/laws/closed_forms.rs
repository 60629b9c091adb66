//! Densities with closed forms.

use mis::technique::{
    Cauchy, Exponential, Linear, Normal, PowerLaw, TruncatedCauchy, TruncatedNormal, Uniform,
};

const INF: f64 = f64::INFINITY;

laws! {
    uniform: Uniform::new(-1.0, 3.0);
    uniform_unit: Some(Uniform::unit());
    uniform_tiny: Uniform::new(0.0, 1e-300);
    uniform_huge: Uniform::new(-8e307, 8e307);
    uniform_far: Uniform::new(1e9, 1e9 + 1.0);
    uniform_one_ulp: Uniform::new(1.0, 1.0 + f64::EPSILON), resolved: false;
}

laws! {
    linear: Linear::new(-1.0, 3.0, 1.0, 2.0);
    linear_up: Linear::new(0.0, 1.0, 0.0, 1.0);
    linear_down: Linear::new(2.0, 5.0, 3.0, 0.0);
    linear_level: Linear::new(0.0, 1.0, 0.7, 0.7);
    linear_nearly_level: Linear::new(0.0, 1.0, 1.0, 1.0 + 1e-15);
    linear_steep: Linear::new(0.0, 1.0, 1e-300, 1e300);
    linear_steep_down: Linear::new(-1.0, 0.0, 1e160, 1e-160);
    linear_subnormal_values: Linear::new(0.0, 1.0, 5e-324, 1e-323);
    linear_tiny: Linear::new(0.0, 1e-300, 0.0, 1.0);
    linear_huge: Linear::new(-8e307, 8e307, 1.0, 2.0);
    linear_one_ulp: Linear::new(1.0, 1.0 + f64::EPSILON, 0.0, 1.0), resolved: false;
}

laws! {
    exponential: Exponential::new(1.0, 0.0, INF);
    exponential_shifted: Exponential::new(0.3, -2.0, INF);
    exponential_cut: Exponential::new(2.0, 1.0, 3.0);
    exponential_growing: Exponential::new(-2.0, 1.0, 3.0);
    exponential_growing_to_0: Exponential::new(-2.0, -3.0, 0.0);
    exponential_level: Exponential::new(0.0, 1.0, 3.0);
    exponential_nearly_level: Exponential::new(1e-17, 0.0, 3.0);
    exponential_nearly_level_growing: Exponential::new(-1e-9, 0.0, 3.0);
    exponential_subnormal_rate: Exponential::new(1e-320, 0.0, 3.0);
    exponential_steep: Exponential::new(1e5, 0.0, 3.0);
    exponential_steep_growing: Exponential::new(-1e5, 0.0, 3.0);
    exponential_depth_700: Exponential::new(700.0, -1.0, 0.0);
    exponential_tiny: Exponential::new(1e300, 0.0, INF);
    exponential_tiny_window: Exponential::new(1e300, 0.0, 1e-300);
    exponential_huge: Exponential::new(1e-280, 0.0, INF);
    exponential_one_ulp: Exponential::new(1.0, 1.0, 1.0 + f64::EPSILON), resolved: false;
}

laws! {
    power_law_flat: PowerLaw::new(0.0, 0.0, 2.0);
    power_law_ramp: PowerLaw::new(1.0, 0.0, 1.0);
    power_law_root: PowerLaw::new(-0.5, 0.0, 1.0), tail_from: 1e-150;
    power_law_singular: PowerLaw::new(-0.9, 0.0, 1.0), tail_from: 1e-20;
    power_law_nearly_log: PowerLaw::new(-0.95, 0.0, 1.0), tail_from: 1e-11;
    power_law_steep: PowerLaw::new(1e6, 0.0, 1.0);
    power_law_cut: PowerLaw::new(2.5, 0.5, 2.0);
    power_law_falling: PowerLaw::new(-3.0, 1.0, 1e3);
    power_law_log: PowerLaw::new(-1.0, 0.5, 4.0);
    power_law_log_wide: PowerLaw::new(-1.0, 1e-300, 1e300);
    power_law_almost_log: PowerLaw::new(-1.0 + 1e-12, 0.5, 4.0);
    power_law_almost_log_wide: PowerLaw::new(-1.01, 1e-290, 1e290);
    power_law_steep_falling: PowerLaw::new(-1e6, 1.0, 2.0);
    power_law_narrow: PowerLaw::new(2.0, 1.0, 1.0 + 1e-9);
    power_law_tiny: PowerLaw::new(2.0, 0.0, 1e-300), tail_from: 1e-20;
    power_law_huge: PowerLaw::new(2.0, 0.0, 1e290);
    power_law_one_ulp: PowerLaw::new(2.0, 1.0, 1.0 + f64::EPSILON), resolved: false;
}

laws! {
    normal: Some(Normal::standard());
    normal_shifted: Normal::new(-3.0, 0.2);
    normal_far: Normal::new(1e9, 1.0);
    normal_tiny: Normal::new(0.0, 1e-300);
    normal_huge: Normal::new(0.0, 1e290);
    normal_below_one_ulp: Normal::new(1e20, 1e-3), resolved: false;
}

laws! {
    cauchy: Cauchy::new(0.0, 1.0);
    cauchy_shifted: Cauchy::new(91.2, 1.25);
    cauchy_tiny: Cauchy::new(0.0, 1e-300);
    cauchy_huge: Cauchy::new(0.0, 1e270), tail_from: 1e-20;
    truncated_cauchy: TruncatedCauchy::new(91.2, 1.25, 60.0, 120.0);
    truncated_cauchy_line: TruncatedCauchy::new(1.0, 2.0, -INF, INF);
    truncated_cauchy_lower_half: TruncatedCauchy::new(0.0, 1.0, -INF, 0.0);
    truncated_cauchy_upper_half: TruncatedCauchy::new(0.0, 1.0, 0.0, INF);
    truncated_cauchy_tail: TruncatedCauchy::new(0.0, 1.0, 1e6, INF);
    truncated_cauchy_lower_tail: TruncatedCauchy::new(0.0, 1.0, -INF, -1e6);
    truncated_cauchy_ending_at_0: TruncatedCauchy::new(-1e9, 1.0, 0.0, 1e-3), tail_from: 1e-280;
    truncated_cauchy_far_window: TruncatedCauchy::new(0.0, 1.0, 1e9, 1e9 + 1.0);
    truncated_cauchy_far_off: TruncatedCauchy::new(0.0, 1.0, 1e200, 2e200);
    truncated_cauchy_wide: TruncatedCauchy::new(0.0, 1.0, -1e200, 1e100), tail_from: 1e-150;
    truncated_cauchy_narrow: TruncatedCauchy::new(0.0, 1e300, 1.0, 2.0);
    truncated_cauchy_tiny: TruncatedCauchy::new(0.0, 1e-300, -1e-300, 3e-300);
    truncated_cauchy_needle: TruncatedCauchy::new(0.0, 1e-30, -1.0, 1.0);
    truncated_cauchy_one_ulp: TruncatedCauchy::new(0.0, 1.0, 1.0, 1.0 + f64::EPSILON), resolved: false;
}

laws! {
    truncated_normal: TruncatedNormal::new(0.0, 1.0, -1.0, 2.0);
    truncated_normal_line: TruncatedNormal::new(1.0, 2.0, -INF, INF);
    truncated_normal_lower_half: TruncatedNormal::new(0.0, 1.0, -INF, 0.0);
    truncated_normal_upper_half: TruncatedNormal::new(0.0, 1.0, 0.0, INF);
    truncated_normal_starting_at_0: TruncatedNormal::new(2.0, 1.0, 0.0, INF);
    truncated_normal_ending_at_0: TruncatedNormal::new(-2.0, 1.0, -INF, 0.0);
    truncated_normal_above_0: TruncatedNormal::new(-2.0, 1.0, 0.0, INF);
    truncated_normal_straddling: TruncatedNormal::new(0.0, 1.0, -30.0, 40.0);
    truncated_normal_one_sd_off: TruncatedNormal::new(0.0, 1.0, 1.0, 4.0);
    truncated_normal_three_sd_off: TruncatedNormal::new(0.0, 1.0, -INF, -3.0);
    truncated_normal_four_sd_off: TruncatedNormal::new(0.0, 1.0, 4.5, 4.8);
    truncated_normal_38_sd_off: TruncatedNormal::new(0.0, 1.0, 38.0, INF);
    truncated_normal_100_sd_off: TruncatedNormal::new(0.0, 1.0, 100.0, 101.0);
    truncated_normal_100_sd_below: TruncatedNormal::new(0.0, 1.0, -101.0, -100.0);
    truncated_normal_far_at_0: TruncatedNormal::new(-1e5, 1.0, 0.0, INF);
    truncated_normal_narrow: TruncatedNormal::new(0.0, 1.0, 0.5, 0.5 + 1e-9);
    truncated_normal_narrow_far: TruncatedNormal::new(0.0, 1.0, 100.0, 100.0 + 1e-9);
    truncated_normal_flat: TruncatedNormal::new(0.0, 1e300, -1.0, 2.0);
    truncated_normal_tiny: TruncatedNormal::new(0.0, 1e-300, -1e-300, 3e-300);
    truncated_normal_needle: TruncatedNormal::new(0.0, 1e-30, -1.0, 1.0);
    truncated_normal_one_ulp: TruncatedNormal::new(0.0, 1.0, 1.0, 1.0 + f64::EPSILON), resolved: false;
}
