/* GSL's plain Monte Carlo, MISER and VEGAS.
 *
 * apt: libgsl-dev
 * cc: -lgsl -lgslcblas
 */
#include "integrand.h"

#include <gsl/gsl_monte_miser.h>
#include <gsl/gsl_monte_plain.h>
#include <gsl/gsl_monte_vegas.h>
#include <gsl/gsl_rng.h>
#include <gsl/gsl_version.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum method { PLAIN, MISER, VEGAS, METHODS };
static const char *const NAMES[METHODS] = {"GSL plain", "GSL MISER", "GSL VEGAS"};

static unsigned long evaluations;

static double f(double *x, size_t d, void *integrand)
{
    (void)d;
    evaluations++;
    return integrand_eval(integrand, x);
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* VEGAS runs five short iterations that adapt the grid and five long ones that make the result, as
 * in the example of GSL's manual. Halves of equal length did worse. */
static void integrate(enum method method, struct integrand *g, gsl_rng *rng, size_t n,
                      double *value, double *error)
{
    gsl_monte_function function = {f, g->d, g};
    double lower[MOST_NUMBERS], upper[MOST_NUMBERS];
    for (size_t i = 0; i < g->d; i++)
        lower[i] = 0, upper[i] = 1;
    if (method == PLAIN) {
        gsl_monte_plain_state *state = gsl_monte_plain_alloc(g->d);
        gsl_monte_plain_integrate(&function, lower, upper, g->d, n, rng, state, value, error);
        gsl_monte_plain_free(state);
    } else if (method == MISER) {
        gsl_monte_miser_state *state = gsl_monte_miser_alloc(g->d);
        gsl_monte_miser_integrate(&function, lower, upper, g->d, n, rng, state, value, error);
        gsl_monte_miser_free(state);
    } else {
        gsl_monte_vegas_state *state = gsl_monte_vegas_alloc(g->d);
        size_t short_n = n / 50, long_n = n * 9 / 50;
        gsl_monte_vegas_integrate(&function, lower, upper, g->d, short_n, rng, state, value, error);
        gsl_monte_vegas_params params;
        gsl_monte_vegas_params_get(state, &params);
        params.stage = 1; /* keep the grid, forget the results */
        gsl_monte_vegas_params_set(state, &params);
        gsl_monte_vegas_integrate(&function, lower, upper, g->d, long_n, rng, state, value, error);
        gsl_monte_vegas_free(state);
    }
}

int main(int argc, char **argv)
{
    if (argc != 4)
        return fprintf(stderr, "usage: gsl SUITE SEEDS EVALUATIONS\n"), 2;
    FILE *suite = fopen(argv[1], "r");
    if (!suite)
        return perror(argv[1]), 1;
    unsigned long seeds = strtoul(argv[2], NULL, 10), n = strtoul(argv[3], NULL, 10);
    printf("# GSL %s\n", gsl_version);
    struct integrand g;
    size_t numbers;
    while (fscanf(suite, "%63s %d %zu %zu", g.name, &g.kind, &g.d, &numbers) == 4) {
        if (numbers > MOST_NUMBERS)
            return fprintf(stderr, "%s has too many parameters\n", g.name), 1;
        for (size_t i = 0; i < numbers; i++)
            if (fscanf(suite, "%lf", &g.p[i]) != 1)
                return fprintf(stderr, "%s has too few parameters\n", g.name), 1;
        integrand_prepare(&g);
        for (int method = 0; method < METHODS; method++)
            for (unsigned long seed = 1; seed <= seeds; seed++) {
                double value, error, start = now();
                gsl_rng *rng = gsl_rng_alloc(gsl_rng_default);
                gsl_rng_set(rng, seed);
                evaluations = 0;
                integrate(method, &g, rng, n, &value, &error);
                gsl_rng_free(rng);
                double seconds = now() - start;
                printf("%s,%s,%lu,%.17g,%.17g,%lu,%.9f\n", g.name, NAMES[method], seed, value,
                       error, evaluations, seconds);
            }
    }
    return 0;
}
