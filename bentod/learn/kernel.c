/* The steps of bentod/learn/lazy_numpy.py, compiled: the same operations on each number in the same order, and so
   the same results to the last bit. Portable C99; the compiler must not contract a*b+c (-ffp-contract=off) or
   reorder sums. bentod/learn/lazy.py explains the algebra and the names. */

#ifndef REAL

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* As in bentod/learn/lazy_compiled.py. Shapes: weights (features, gvfs) with rows `stride` numbers apart; c, stale,
   active, rows, before, share (features,); the others (gvfs,). */
typedef struct {
    intptr_t features, gvfs, stride;
    void *weights;
    double *c;
    unsigned char *stale, *active;
    intptr_t *rows, *before;
    double *share; /* scratch */
    double *cumulants, *d, *d_old, *v, *v_old, *delta, *peak, *base, *initial;
    int64_t *resets;
    double alpha, negligible, reach;
    intptr_t online;
} Lazy;

/* What is the same for all GVFs of one step. */
typedef struct {
    intptr_t count, before; /* rows active now, and before */
    double gamma, s, s_next, kept, horizon;
    intptr_t turn;
} Step;

enum { ON = 0, EPOCH = 1, FORGET = 2, BEGIN = 3 };

/* Columns are dealt with in blocks, so that the rows of one are still in the cache when they are written. */
#define BLOCK 128

/* How far ahead rows are fetched. They lie far apart, and at 30 Hz nothing is in the cache. */
#define AHEAD 6

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && defined(__GLIBC__)
#define WIDE __attribute__((flatten, target_clones("avx512f", "avx2", "default")))
#else
#define WIDE
#endif

#if defined(__GNUC__)
#define FETCH(address) __builtin_prefetch((address), 1)
#else
#define FETCH(address) ((void)(address))
#endif

#define TEXT_(x) #x
#define TEXT(x) TEXT_(x)
#ifndef SOURCE
#define SOURCE unknown
#endif

const char *kernel_source(void) { return TEXT(SOURCE); }

const char *kernel_compiler(void) {
#if defined(__clang__)
    return "clang " TEXT(__clang_major__) "." TEXT(__clang_minor__);
#elif defined(__GNUC__)
    return "gcc " TEXT(__GNUC__) "." TEXT(__GNUC_MINOR__);
#else
    return "C compiler";
#endif
}

/* Whether the active features ascend within bounds: others would be written outside of the arrays. */
static int sound(const Lazy *g, intptr_t count) {
    intptr_t last = -1;
    for (intptr_t i = 0; i < count; i++) {
        if (g->rows[i] <= last) return 0;
        last = g->rows[i];
    }
    return last < g->features;
}

static double total(const Lazy *g, intptr_t count) {
    double sum = count ? g->c[g->rows[0]] : 0;
    for (intptr_t i = 1; i < count; i++) sum += g->c[g->rows[i]];
    return sum;
}

/* Rescale c of one row into the present epoch. Returns what it was, 0 when the row was not stale. */
static double renew(const Lazy *g, intptr_t row, double kept) {
    if (!g->stale[row]) return 0;
    double c = g->c[row], now = c * kept;
    g->c[row] = fabs(now) < g->negligible ? 0 : now;
    g->stale[row] = 0;
    return c;
}

static void enter(const Lazy *g, const Step *a) {
    for (intptr_t i = 0; i < a->before; i++) g->active[g->before[i]] = 0;
    for (intptr_t i = 0; i < a->count; i++) g->active[g->rows[i]] = 1;
    memcpy(g->before, g->rows, (size_t)a->count * sizeof *g->rows);
}

#define REAL float
#define NAME(name) name##_float32
#include "kernel.c"
#undef REAL
#undef NAME
#define REAL double
#define NAME(name) name##_float64
#include "kernel.c"

#else

/* Add c D to columns from..from+width of one row. */
static inline void NAME(add)(const Lazy *g, intptr_t row, double c, const double *d, intptr_t from, intptr_t width) {
    REAL *restrict w = (REAL *)g->weights + row * g->stride + from;
    const double *restrict by = d + from;
    for (intptr_t j = 0; j < width; j++) w[j] += (REAL)(c * by[j]);
}

static inline void NAME(sum)(const Lazy *g, intptr_t count, intptr_t from, intptr_t width, REAL *restrict sum) {
    const REAL *w = (const REAL *)g->weights + from;
    intptr_t i = 0;
    for (intptr_t j = 0; j < width; j++) sum[j] = 0;
    for (; i + 3 < count; i += 4) {
        const REAL *a = w + g->rows[i] * g->stride, *b = w + g->rows[i + 1] * g->stride;
        const REAL *c = w + g->rows[i + 2] * g->stride, *d = w + g->rows[i + 3] * g->stride;
        for (intptr_t next = i + AHEAD; next < i + AHEAD + 4 && next < count; next++)
            for (intptr_t j = 0; j < width; j += (intptr_t)(64 / sizeof(REAL))) FETCH(w + g->rows[next] * g->stride + j);
        for (intptr_t j = 0; j < width; j++) sum[j] = (((sum[j] + a[j]) + b[j]) + c[j]) + d[j];
    }
    for (; i < count; i++) {
        const REAL *a = w + g->rows[i] * g->stride;
        for (intptr_t j = 0; j < width; j++) sum[j] += a[j];
    }
}

/* The GVFs' own part of a step: δ, D and the values of φ_{t+1}. */
static inline void NAME(teach)(
    const Lazy *g, const Step *a, double c, double overlap, intptr_t from, intptr_t width, const REAL *restrict sum
) {
    const double *restrict cumulant = g->cumulants + from;
    double *restrict d = g->d + from, *restrict v = g->v + from, *restrict v_old = g->v_old + from;
    double *restrict delta = g->delta + from, *restrict peak = g->peak + from;
    const double pace = g->alpha * a->s;
    for (intptr_t j = 0; j < width; j++) {
        double raw = (double)sum[j] + c * d[j];
        double change = g->online ? v[j] - v_old[j] : 0;
        double arrived = g->online ? raw + g->alpha * change * overlap : raw;
        double error = cumulant[j] + a->gamma * arrived - v[j];
        int taught = fabs(cumulant[j]) <= DBL_MAX; /* neither NaN nor infinite */
        double size = taught ? fabs(cumulant[j]) : 0;
        delta[j] = taught ? error : NAN;
        double move = pace * (g->online ? (taught ? error : 0) + change : (taught ? error : 0));
        d[j] += move;
        v[j] = raw + c * move;
        v_old[j] = a->s_next == 0 ? v[j] : arrived;
        peak[j] = size > peak[j] ? size : peak[j];
    }
}

/* Take from the active rows what the growth of c adds to them, and the correction of the next step in advance. */
static inline void NAME(enter)(const Lazy *g, const Step *a, double growth, intptr_t from, intptr_t width) {
    REAL x[BLOCK];
    for (intptr_t j = 0; j < width; j++) {
        double less = growth * g->d[from + j];
        if (g->online) less += g->alpha * (g->v[from + j] - g->v_old[from + j]);
        x[j] = (REAL)less;
    }
    for (intptr_t i = 0; i < a->count; i++) {
        REAL *restrict w = (REAL *)g->weights + g->rows[i] * g->stride + from;
        for (intptr_t j = 0; j < width; j++) w[j] -= x[j];
    }
}

/* D of an epoch ends: into the weights of the active rows, and kept for the others. */
static inline void NAME(turn)(const Lazy *g, const Step *a, intptr_t from, intptr_t width) {
    if (a->turn == EPOCH) {
        for (intptr_t i = 0; i < a->count; i++)
            if (g->share[i] != 0) NAME(add)(g, g->rows[i], g->share[i], g->d, from, width);
        memcpy(g->d_old + from, g->d + from, (size_t)width * sizeof(double));
    } else {
        for (intptr_t i = 0; i < a->before; i++) NAME(add)(g, g->before[i], g->share[i], g->d, from, width);
    }
    memset(g->d + from, 0, (size_t)width * sizeof(double));
}

static void NAME(restart)(const Lazy *g, intptr_t count, intptr_t j) {
    REAL *w = (REAL *)g->weights + j;
    for (intptr_t row = 0; row < g->features; row++) w[row * g->stride] = (REAL)g->initial[j];
    g->d[j] = g->d_old[j] = 0;
    g->v[j] = g->v_old[j] = (double)count * g->initial[j];
    g->delta[j] = NAN;
    g->resets[j]++;
}

static void NAME(check)(const Lazy *g, const Step *a) {
    for (intptr_t j = 0; j < g->gvfs; j++) {
        double bound = g->reach * ((double)a->count * g->base[j] + a->horizon * g->peak[j]);
        if (!(fabs(g->v[j]) <= (bound < DBL_MAX ? bound : DBL_MAX))) NAME(restart)(g, a->count, j);
    }
}

/* Fold rows start..stop that are stale. */
WIDE void NAME(fold)(const Lazy *g, intptr_t start, intptr_t stop, double kept) {
    for (intptr_t row = start; row < stop; row++) {
        double c = renew(g, row, kept);
        if (c != 0) NAME(add)(g, row, c, g->d_old, 0, g->gvfs);
    }
}

/* The state of c through a turn: `share` is what each row that is folded has of D. Returns Σ c of the active rows. */
static double NAME(turned)(const Lazy *g, const Step *a, double c) {
    if (a->turn == EPOCH) {
        memset(g->stale, 1, (size_t)g->features);
        for (intptr_t i = 0; i < a->count; i++) g->share[i] = renew(g, g->rows[i], a->s_next);
        return total(g, a->count);
    }
    if (a->turn == FORGET) {
        for (intptr_t i = 0; i < a->before; i++) {
            g->share[i] = g->c[g->before[i]];
            g->c[g->before[i]] = 0;
        }
        return 0;
    }
    return c;
}

static inline void NAME(block)(
    const Lazy *g, const Step *a, double c, double overlap, double growth, intptr_t from, intptr_t width
) {
    REAL sum[BLOCK];
    NAME(sum)(g, a->count, from, width, sum);
    if (a->turn == BEGIN) {
        for (intptr_t j = 0; j < width; j++) {
            g->v[from + j] = g->v_old[from + j] = (double)sum[j];
            g->delta[from + j] = NAN;
        }
        return;
    }
    NAME(teach)(g, a, c, overlap, from, width, sum);
    if (a->turn != ON) NAME(turn)(g, a, from, width);
    if (a->turn == ON || (g->online && a->s_next != 0)) NAME(enter)(g, a, growth, from, width);
}

/* One step; 0, or 1 when the active features do not ascend within bounds, and then nothing was done. */
WIDE int NAME(step)(
    const Lazy *g, intptr_t count, intptr_t before, double gamma, double s_now, double s_next, double kept,
    double horizon, intptr_t turn, intptr_t sweep, intptr_t swept
) {
    const Step step = {count, before, gamma, s_now, s_next, kept, horizon, turn}, *a = &step;
    if (!sound(g, count)) return 1;
    NAME(fold)(g, sweep, swept, kept);
    double overlap = 0;
    for (intptr_t i = 0; i < a->count; i++) {
        if (g->stale[g->rows[i]]) NAME(fold)(g, g->rows[i], g->rows[i] + 1, kept);
        overlap += g->active[g->rows[i]];
    }
    double c = total(g, a->count);
    double after = NAME(turned)(g, a, c);
    double s = a->turn == ON ? a->s_next : 1;
    double growth = g->online ? (1 - g->alpha * s * after) / s : 1 / s;
    for (intptr_t from = 0; from < g->gvfs; from += BLOCK) {
        intptr_t width = g->gvfs - from < BLOCK ? g->gvfs - from : BLOCK;
        NAME(block)(g, a, c, overlap, growth, from, width);
    }
    for (intptr_t i = 0; i < a->count; i++) g->c[g->rows[i]] += growth;
    NAME(check)(g, a);
    enter(g, a);
    return 0;
}

#endif
