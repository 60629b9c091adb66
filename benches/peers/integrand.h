/* The integrands of suite.json in C; see the table of kinds in README.md. */
#ifndef INTEGRAND_H
#define INTEGRAND_H

#include <stddef.h>

enum { MOST_NUMBERS = 64 };

struct integrand {
    char name[64];
    int kind;
    size_t d;
    double p[MOST_NUMBERS]; /* as in the suite */
    double c[MOST_NUMBERS]; /* what can be computed beforehand */
};

/* Computes c from kind, d and p. */
void integrand_prepare(struct integrand *f);

/* f(x) on the unit cube. */
double integrand_eval(const struct integrand *f, const double *x);

/* f of n points, one after the other. */
void integrand_eval_batch(const struct integrand *f, const double *x, size_t n, double *y);

#endif
