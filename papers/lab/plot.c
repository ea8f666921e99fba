#include "papers/lab/plot.h"

#include "papers/lab/file.h"

#include <math.h>
#include <stdio.h>

/* sizes in pixels */
enum { WIDTH = 920, HEIGHT = 460, LEFT = 96, RIGHT = 250, TOP = 44, BOTTOM = 56 };

/* Okabe and Ito 2008: told apart also by the colour-blind */
static const char *const colors[LAB_CURVES] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                               "#e69f00", "#56b4e9", "#000000", "#999999"};

enum { TICKS = 64 };

typedef struct axis {
    bool log;
    double low, high; /* of the value or of its logarithm to base 10 */
    double ticks[TICKS];
    int tick_count;
    int from, to; /* pixels */
} axis;

static double on_scale(const axis *a, double value)
{
    return a->log ? log10(value) : value;
}

static double pixel(const axis *a, double value)
{
    return a->from + (on_scale(a, value) - a->low) / (a->high - a->low) * (a->to - a->from);
}

/* 1, 2 or 5 times a power of ten, so that about `count` steps make up the span */
static double round_step(double span, int count)
{
    double power = pow(10, floor(log10(span / count))), rest = span / count / power;
    return power * (rest < 1.5 ? 1 : rest < 3.5 ? 2 : rest < 7.5 ? 5 : 10);
}

/* multiples of a round step, the first at or below the lowest value, the last at or above the highest */
static void set_ticks(axis *a)
{
    double step = round_step(a->high - a->low, 6);
    for (double i = floor(a->low / step + 1e-9); a->tick_count < TICKS; i++) {
        a->ticks[a->tick_count++] = i * step;
        if (i * step >= a->high - 1e-9 * step)
            break;
    }
}

/* 1, 2 and 5 times the powers of ten, likewise; the powers alone when the span is wide */
static void set_log_ticks(axis *a)
{
    static const double parts[3] = {1, 2, 5};
    bool wide = a->high - a->low > 3;
    double last = pow(10, a->high), first = pow(10, a->low);
    for (double power = pow(10, floor(a->low)); a->tick_count < TICKS; power *= 10)
        for (int i = 0; i < (wide ? 1 : 3); i++) {
            double tick = power * parts[i];
            if (tick <= first * (1 + 1e-9))
                a->tick_count = 0;
            a->ticks[a->tick_count++] = tick;
            if (tick >= last * (1 - 1e-9))
                return;
        }
}

static void fit_axis(const lab_plot *plot, bool vertical, axis *a)
{
    a->low = HUGE_VAL;
    a->high = -HUGE_VAL;
    for (int c = 0; c < plot->curve_count; c++)
        for (int i = 0; i < plot->curves[c].count; i++) {
            double value = on_scale(a, vertical ? plot->curves[c].y[i] : plot->curves[c].x[i]);
            a->low = fmin(a->low, value);
            a->high = fmax(a->high, value);
        }
    if (plot->bars && vertical)
        a->low = fmin(a->low, 0);
    if (plot->bars && !vertical) {
        /* room for half a group at both ends */
        double half = plot->curves[0].count > 1 ? 0.5 * (a->high - a->low) / (plot->curves[0].count - 1) : 0.5;
        a->low -= half;
        a->high += half;
    }
    if (!(a->high > a->low)) {
        a->low -= 0.5;
        a->high += 0.5;
    }
    if (a->log)
        set_log_ticks(a);
    else
        set_ticks(a);
    a->low = on_scale(a, a->ticks[0]);
    a->high = on_scale(a, a->ticks[a->tick_count - 1]);
}

static void write_text(FILE *file, double x, double y, const char *anchor, const char *text)
{
    fprintf(file, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchor);
    lab_put_escaped(file, text);
    fputs("</text>\n", file);
}

static void write_axis(FILE *file, const axis *a, bool vertical)
{
    double step = a->tick_count > 1 ? a->ticks[1] - a->ticks[0] : 1;
    for (int i = 0; i < a->tick_count; i++) {
        double value = a->ticks[i], at = pixel(a, value);
        char text[32];
        snprintf(text, sizeof text, "%.6g", fabs(value) < 1e-9 * step ? 0 : value);
        if (vertical) {
            fprintf(file, "<path d=\"M%d %.1fH%d\" stroke=\"#ddd\"/>\n", LEFT, at, WIDTH - RIGHT);
            write_text(file, LEFT - 8, at + 4, "end", text);
        } else {
            fprintf(file, "<path d=\"M%.1f %dV%d\" stroke=\"#ddd\"/>\n", at, TOP, HEIGHT - BOTTOM);
            write_text(file, at, HEIGHT - BOTTOM + 18, "middle", text);
        }
    }
}

static void write_curve(FILE *file, const lab_curve *curve, const char *color, const axis *x, const axis *y)
{
    fprintf(file, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"2\" d=\"", color);
    for (int i = 0; i < curve->count; i++)
        fprintf(file, "%c%.2f %.2f", i == 0 ? 'M' : 'L', pixel(x, curve->x[i]), pixel(y, curve->y[i]));
    fputs("\"/>\n", file);
    for (int i = 0; curve->marks && i < curve->count; i++)
        fprintf(file, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"4\" fill=\"%s\"/>\n", pixel(x, curve->x[i]),
                pixel(y, curve->y[i]), color);
}

/* the bars of curve c of the plot: next to those of the others, around their x */
static void write_bars(FILE *file, const lab_plot *plot, int c, const axis *x, const axis *y)
{
    const lab_curve *curve = &plot->curves[c];
    double step = curve->count > 1 ? pixel(x, curve->x[1]) - pixel(x, curve->x[0]) : x->to - x->from;
    double width = 0.8 * step / plot->curve_count, foot = pixel(y, 0);
    for (int i = 0; i < curve->count; i++) {
        double left = pixel(x, curve->x[i]) - 0.4 * step + c * width, top = pixel(y, curve->y[i]);
        fprintf(file, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"%s\"/>\n", left, top, width,
                fmax(foot - top, 0), colors[c]);
    }
}

static void write_legend(FILE *file, const lab_plot *plot)
{
    for (int c = 0; c < plot->curve_count; c++) {
        int y = TOP + 16 + 18 * c, x = WIDTH - RIGHT + 12;
        fprintf(file, "<path d=\"M%d %dh24\" stroke=\"%s\" stroke-width=\"%d\"/>\n", x, y - 4, colors[c],
                plot->bars ? 8 : 2);
        write_text(file, x + 30, y, "start", plot->curves[c].name);
    }
}

static void write_plot(FILE *file, const void *context)
{
    const lab_plot *plot = context;
    axis x = {.log = plot->log_x, .from = LEFT, .to = WIDTH - RIGHT};
    axis y = {.log = plot->log_y, .from = HEIGHT - BOTTOM, .to = TOP};
    fit_axis(plot, false, &x);
    fit_axis(plot, true, &y);
    fprintf(file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
            "font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
            WIDTH, HEIGHT, WIDTH, HEIGHT);
    write_axis(file, &x, false);
    write_axis(file, &y, true);
    fprintf(file, "<path d=\"M%d %dV%dH%d\" fill=\"none\" stroke=\"black\"/>\n", LEFT, TOP, HEIGHT - BOTTOM,
            WIDTH - RIGHT);
    for (int c = 0; c < plot->curve_count; c++)
        if (plot->bars)
            write_bars(file, plot, c, &x, &y);
        else
            write_curve(file, &plot->curves[c], colors[c], &x, &y);
    write_legend(file, plot);
    write_text(file, (LEFT + WIDTH - RIGHT) / 2.0, 26, "middle", plot->title);
    write_text(file, (LEFT + WIDTH - RIGHT) / 2.0, HEIGHT - 14, "middle", plot->x_name);
    fprintf(file, "<g transform=\"translate(20 %d) rotate(-90)\">", HEIGHT / 2);
    write_text(file, 0, 0, "middle", plot->y_name);
    fputs("</g>\n</svg>\n", file);
}

pel_status lab_write_plot(const char *path, const lab_plot *plot, pel_error *error)
{
    return lab_write_file(path, "plot", write_plot, plot, error);
}
