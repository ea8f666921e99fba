#include "papers/lab/plot.h"

#include "papers/lab/file.h"

#include <pellicle/error.h>
#ifdef PELLICLE_VIEW
#include <pellicle/render.h>
#endif

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* sizes in pixels */
enum { WIDTH = 920, HEIGHT = 460, LEFT = 96, RIGHT = 36, LEGEND = 250, TOP = 44, BOTTOM = 56 };

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

/* ---- drawing ---- */

/* what a plot is drawn with: an SVG file, or a picture */
typedef struct pen {
    void *target;
    void (*line)(void *target, const double *points, int count, double width, const char *color);
    void (*dot)(void *target, double x, double y, const char *color);
    void (*fill)(void *target, double x, double y, double width, double height, const char *color);
    /* anchor: start, middle or end */
    void (*text)(void *target, double x, double y, const char *anchor, bool upward, const char *text);
} pen;

static void draw_line(const pen *p, double x0, double y0, double x1, double y1, double width, const char *color)
{
    p->line(p->target, (double[4]){x0, y0, x1, y1}, 2, width, color);
}

/* with lines across the plot, which ends at `right` */
static void draw_axis(const pen *p, const axis *a, int right, bool vertical)
{
    double step = a->tick_count > 1 ? a->ticks[1] - a->ticks[0] : 1;
    for (int i = 0; i < a->tick_count; i++) {
        double value = a->ticks[i], at = pixel(a, value);
        char text[32];
        snprintf(text, sizeof text, "%.6g", fabs(value) < 1e-9 * step ? 0 : value);
        if (vertical) {
            draw_line(p, LEFT, at, right, at, 1, "#dddddd");
            p->text(p->target, LEFT - 8, at + 4, "end", false, text);
        } else {
            draw_line(p, at, TOP, at, HEIGHT - BOTTOM, 1, "#dddddd");
            p->text(p->target, at, HEIGHT - BOTTOM + 18, "middle", false, text);
        }
    }
}

static void draw_curve(const pen *p, const lab_curve *curve, const char *color, const axis *x, const axis *y,
                       double *points)
{
    for (int i = 0; i < curve->count; i++) {
        points[2 * i] = pixel(x, curve->x[i]);
        points[2 * i + 1] = pixel(y, curve->y[i]);
        if (curve->marks)
            p->dot(p->target, points[2 * i], points[2 * i + 1], color);
    }
    p->line(p->target, points, curve->count, 2, color);
}

/* the bars of curve c of the plot: next to those of the others, around their x */
static void draw_bars(const pen *p, const lab_plot *plot, int c, const axis *x, const axis *y)
{
    const lab_curve *curve = &plot->curves[c];
    double step = curve->count > 1 ? pixel(x, curve->x[1]) - pixel(x, curve->x[0]) : x->to - x->from;
    double width = 0.8 * step / plot->curve_count, foot = pixel(y, 0);
    for (int i = 0; i < curve->count; i++) {
        double left = pixel(x, curve->x[i]) - 0.4 * step + c * width, top = pixel(y, curve->y[i]);
        p->fill(p->target, left, top, width, fmax(foot - top, 0), colors[c]);
    }
}

static void draw_legend(const pen *p, const lab_plot *plot)
{
    for (int c = 0; c < plot->curve_count; c++) {
        int y = TOP + 16 + 18 * c, x = WIDTH - LEGEND + 12;
        draw_line(p, x, y - 4, x + 24, y - 4, plot->bars ? 8 : 2, colors[c]);
        p->text(p->target, x + 30, y, "start", false, plot->curves[c].name);
    }
}

/* points: scratch, two numbers for each point of the longest curve */
static void draw_plot(const pen *p, const lab_plot *plot, double *points)
{
    const bool legend = plot->curve_count != 1 || plot->curves[0].name[0] != '\0';
    const int right = WIDTH - (legend ? LEGEND : RIGHT);
    axis x = {.log = plot->log_x, .from = LEFT, .to = right};
    axis y = {.log = plot->log_y, .from = HEIGHT - BOTTOM, .to = TOP};
    fit_axis(plot, false, &x);
    fit_axis(plot, true, &y);
    draw_axis(p, &x, right, false);
    draw_axis(p, &y, right, true);
    draw_line(p, LEFT, TOP, LEFT, HEIGHT - BOTTOM, 1, "#000000");
    draw_line(p, LEFT, HEIGHT - BOTTOM, right, HEIGHT - BOTTOM, 1, "#000000");
    for (int c = 0; c < plot->curve_count; c++)
        if (plot->bars)
            draw_bars(p, plot, c, &x, &y);
        else
            draw_curve(p, &plot->curves[c], colors[c], &x, &y, points);
    if (legend)
        draw_legend(p, plot);
    p->text(p->target, (LEFT + right) / 2.0, 26, "middle", false, plot->title);
    p->text(p->target, (LEFT + right) / 2.0, HEIGHT - 14, "middle", false, plot->x_name);
    p->text(p->target, 20, HEIGHT / 2.0, "middle", true, plot->y_name);
}

static double *make_points(const lab_plot *plot, pel_error *error)
{
    size_t most = 1;
    for (int c = 0; c < plot->curve_count; c++)
        most = (size_t)plot->curves[c].count > most ? (size_t)plot->curves[c].count : most;
    double *points = calloc(most, 2 * sizeof *points);
    if (points == NULL)
        pel_fail_memory(error);
    return points;
}

/* ---- SVG ---- */

static void svg_line(void *target, const double *points, int count, double width, const char *color)
{
    FILE *file = target;
    fprintf(file, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"%g\" d=\"", color, width);
    for (int i = 0; i < count; i++)
        fprintf(file, "%c%.2f %.2f", i == 0 ? 'M' : 'L', points[2 * i], points[2 * i + 1]);
    fputs("\"/>\n", file);
}

static void svg_dot(void *target, double x, double y, const char *color)
{
    fprintf(target, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"4\" fill=\"%s\"/>\n", x, y, color);
}

static void svg_fill(void *target, double x, double y, double width, double height, const char *color)
{
    fprintf(target, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"%s\"/>\n", x, y, width, height,
            color);
}

static void svg_text(void *target, double x, double y, const char *anchor, bool upward, const char *text)
{
    FILE *file = target;
    fprintf(file, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\"", x, y, anchor);
    if (upward)
        fprintf(file, " transform=\"rotate(-90 %.1f %.1f)\"", x, y);
    fputs(">", file);
    lab_put_escaped(file, text);
    fputs("</text>\n", file);
}

typedef struct svg_plot {
    const lab_plot *plot;
    double *points;
} svg_plot;

static void write_svg(FILE *file, const void *context)
{
    const svg_plot *svg = context;
    const pen p = {file, svg_line, svg_dot, svg_fill, svg_text};
    fprintf(file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" "
            "font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
            WIDTH, HEIGHT, WIDTH, HEIGHT);
    draw_plot(&p, svg->plot, svg->points);
    fputs("</svg>\n", file);
}

pel_status lab_write_plot(const char *path, const lab_plot *plot, pel_error *error)
{
    svg_plot svg = {plot, make_points(plot, error)};
    if (svg.points == NULL)
        return PEL_OUT_OF_MEMORY;
    pel_status status = lab_write_file(path, "plot", write_svg, &svg, error);
    free(svg.points);
    return status;
}

/* ---- PNG ---- */

#ifdef PELLICLE_VIEW
/* pixels per unit, for screens of double density and for paper */
#define PICTURE_SCALE 2.0

/* "#rrggbb" */
static void read_color(const char *color, uint8_t rgb[3])
{
    const unsigned long value = strtoul(color + 1, NULL, 16);
    for (int i = 0; i < 3; i++)
        rgb[i] = (uint8_t)(value >> (16 - 8 * i));
}

static void png_line(void *target, const double *points, int count, double width, const char *color)
{
    uint8_t rgb[3];
    read_color(color, rgb);
    pel_canvas_line(target, points, count, width, rgb);
}

static void png_dot(void *target, double x, double y, const char *color)
{
    png_line(target, (double[2]){x, y}, 1, 8, color);
}

static void png_fill(void *target, double x, double y, double width, double height, const char *color)
{
    uint8_t rgb[3];
    read_color(color, rgb);
    pel_canvas_fill(target, x, y, width, height, rgb);
}

static void png_text(void *target, double x, double y, const char *anchor, bool upward, const char *text)
{
    pel_canvas_text(target, x, y,
                    anchor[0] == 'm'   ? PEL_CANVAS_MIDDLE
                    : anchor[0] == 'e' ? PEL_CANVAS_END
                                       : PEL_CANVAS_START,
                    upward, text);
}

pel_status lab_draw_plot(const char *path, const lab_plot *plot, pel_error *error)
{
    pel_canvas *canvas;
    double *points = make_points(plot, error);
    if (points == NULL)
        return PEL_OUT_OF_MEMORY;
    pel_status status = pel_canvas_create(WIDTH, HEIGHT, PICTURE_SCALE, &canvas, error);
    if (status == PEL_OK) {
        draw_plot(&(pen){canvas, png_line, png_dot, png_fill, png_text}, plot, points);
        status = pel_canvas_write(canvas, path, error);
    }
    pel_canvas_destroy(canvas);
    free(points);
    return status;
}
#else
pel_status lab_draw_plot(const char *path, const lab_plot *plot, pel_error *error)
{
    (void)plot;
    pel_fail(error, PEL_BAD_ARGUMENT, "this program was built without pictures");
    pel_fail_remedy(error, "write a .svg file, or build with -DPELLICLE_VIEW=ON");
    pel_fail_place(error, path, 0, 0);
    return PEL_BAD_ARGUMENT;
}
#endif
