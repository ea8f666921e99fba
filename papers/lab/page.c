/* The page about experiments that ran, in the order of the papers: counts, then for each the statements with their
   numbers and verdicts, its tables and its pictures. Once as HTML and once as Markdown; both use relative paths, so
   that the folder can be moved. */
#include "papers/lab/page.h"

#include "papers/lab/file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* "name 0.42 <= 0.75" of the numbers that are judged for a claim, some of them */
static void measured(const lab_experiment *experiment, int claim, char *text, size_t size)
{
    enum { MOST = 5 };
    int count = 0;
    size_t length = 0;
    text[0] = '\0';
    for (int i = 0; i < experiment->finding_count; i++) {
        const lab_finding *finding = &experiment->findings[i];
        if (finding->claim != claim || finding->relation == LAB_TOLD)
            continue;
        count++;
        if (count > MOST || length + 160 > size)
            continue;
        length +=
            (size_t)snprintf(text + length, size - length, "%s%s %.4g (%s %.4g", count > 1 ? "; " : "", finding->name,
                             finding->value, lab_relation_sign(finding->relation), finding->expected);
        if (finding->relation == LAB_EQUAL && finding->tolerance > 0)
            length += (size_t)snprintf(text + length, size - length, " +- %.2g", finding->tolerance);
        length += (size_t)snprintf(text + length, size - length, ")");
    }
    if (count > MOST)
        snprintf(text + length, size - length, "; and %d more", count - MOST);
}

static const char head[] =
    "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
    "content=\"width=device-width, initial-scale=1\">\n<title>Pellicle: both papers</title>\n<style>\nbody { font: "
    "15px/1.45 sans-serif; max-width: 1100px; margin: 2em auto; padding: 0 1em; color: #222; }\ntable { "
    "border-collapse: collapse; width: 100%; } td, th { border-bottom: 1px solid #ddd; padding: 4px 8px; text-align: "
    "left; vertical-align: top; }\ntd.number { text-align: right; font-variant-numeric: tabular-nums; } img { "
    "max-width: 100%; }\n.holds { color: #00703c; } .differs { color: #b35900; } .fails { color: #b00020; font-weight: "
    "bold; } .told { color: #666; }\nfigure { margin: 1em 0; } figcaption { color: #555; } summary { cursor: pointer; "
    "}\n</style>\n</head>\n<body>\n<h1>Reproduction of both papers</h1>\n";

static void put_verdict(FILE *file, const lab_experiment *experiment, int claim)
{
    char text[512];
    fprintf(file, "<span class=\"%s\">", lab_verdict_name(lab_claim_verdict(experiment, claim)));
    lab_put_escaped(file, lab_claim_text(experiment, claim, text, sizeof text));
    fputs("</span>", file);
}

static bool is_said(const lab_experiment *experiment, int claim)
{
    return lab_claim_verdict(experiment, claim) != LAB_ONLY_TOLD;
}

typedef struct page {
    const lab_experiment *const *experiments; /* (count) */
    int count;
} page;

/* ---- counts ---- */

/* Judged numbers and their claims, apart from comparisons with the version before. */
typedef struct tally {
    int claims[LAB_FAILS + 1]; /* by verdict */
    int numbers, held;
    int rows, built; /* numbers of both papers' experiments; those by construction */
} tally;

static tally count_all(const page *all)
{
    tally sums = {0};
    for (int i = 0; i < all->count; i++) {
        const lab_experiment *experiment = all->experiments[i];
        for (int claim = 0; claim < experiment->claim_count; claim++)
            if (experiment->claims[claim].origin != LAB_REGRESSION)
                sums.claims[lab_claim_verdict(experiment, claim)]++;
        for (int k = 0; k < experiment->finding_count; k++) {
            const lab_finding *finding = &experiment->findings[k];
            const lab_claim *claim = &experiment->claims[finding->claim];
            if (finding->relation == LAB_TOLD || claim->origin == LAB_REGRESSION)
                continue;
            sums.numbers++;
            sums.held += lab_finding_holds(finding);
            sums.rows += strcmp(experiment->group, "own") != 0;
            sums.built += claim->by_construction;
        }
    }
    return sums;
}

static void put_counts(FILE *file, const page *all)
{
    tally sums = count_all(all);
    fprintf(
        file,
        "%d claims hold, %d differ, %d fail. %d of %d judged numbers are within their limits; %d of them hold by "
        "construction. %d judged numbers belong to experiments of the papers: these are the rows that broken formulas "
        "have to make fail. Comparisons with the version before are not counted.",
        sums.claims[LAB_HOLDS], sums.claims[LAB_DIFFERS], sums.claims[LAB_FAILS], sums.held, sums.numbers, sums.built,
        sums.rows);
}

/* "paper B, section 6, figure 14", or the group alone */
static const char *place_of(const lab_experiment *experiment, char text[160])
{
    if (experiment->place != NULL)
        snprintf(text, 160, "%s, %s", experiment->group, experiment->place);
    else
        snprintf(text, 160, "%s", strcmp(experiment->group, "own") == 0 ? "own check" : experiment->group);
    return text;
}

/* writes the cells of a row, each between `before` and `after` */
static void put_cells(FILE *file, const char *cells, const char *before, const char *after)
{
    char cell[240];
    while (cells != NULL) {
        const char *bar = strchr(cells, '|');
        snprintf(cell, sizeof cell, "%.*s", bar != NULL ? (int)(bar - cells) : (int)strlen(cells), cells);
        fputs(before, file);
        lab_put_escaped(file, cell);
        fputs(after, file);
        cells = bar != NULL ? bar + 1 : NULL;
    }
}

/* ---- HTML ---- */

static void put_claims(FILE *file, const lab_experiment *experiment)
{
    char text[2048];
    fputs("<table>\n<tr><th>from</th><th>statement</th><th>measured (wanted)</th><th>verdict</th></tr>\n", file);
    for (int claim = 0; claim < experiment->claim_count; claim++) {
        if (!is_said(experiment, claim))
            continue;
        fprintf(file, "<tr><td>%s</td><td>", lab_origin_name(experiment->claims[claim].origin));
        lab_put_escaped(file, experiment->claims[claim].says);
        fputs("</td><td>", file);
        measured(experiment, claim, text, sizeof text);
        lab_put_escaped(file, text);
        fputs("</td><td>", file);
        put_verdict(file, experiment, claim);
        fputs("</td></tr>\n", file);
    }
    fputs("</table>\n", file);
}

static void put_tables(FILE *file, const lab_experiment *experiment)
{
    for (int i = 0; i < experiment->row_count; i++) {
        const lab_row *row = &experiment->rows[i];
        if (row->is_head) {
            fputs("<p>", file);
            lab_put_escaped(file, row->caption);
            fputs("</p>\n<table>\n", file);
        }
        fputs("<tr>", file);
        put_cells(file, row->cells, row->is_head ? "<th>" : "<td>", row->is_head ? "</th>" : "</td>");
        fputs("</tr>\n", file);
        if (i + 1 == experiment->row_count || experiment->rows[i + 1].is_head)
            fputs("</table>\n", file);
    }
}

static void put_numbers(FILE *file, const lab_experiment *experiment)
{
    fputs("<details><summary>all numbers</summary>\n<table>\n"
          "<tr><th>number</th><th>value</th><th>wanted</th><th>source</th></tr>\n",
          file);
    for (int i = 0; i < experiment->finding_count; i++) {
        static const char *const relations[] = {"beside ", "", "at most ", "at least "};
        const lab_finding *f = &experiment->findings[i];
        fputs("<tr><td>", file);
        lab_put_escaped(file, f->name);
        fprintf(file, "</td><td class=\"number\">%.6g</td><td>", f->value);
        if (!isnan(f->expected))
            fprintf(file, "%s%.6g", relations[f->relation], f->expected);
        if (f->relation == LAB_EQUAL && f->tolerance > 0)
            fprintf(file, " &plusmn; %.2g", f->tolerance);
        if (!lab_finding_holds(f))
            fputs(" <span class=\"differs\">(not so)</span>", file);
        fputs("</td><td>", file);
        lab_put_escaped(file, f->source);
        fputs("</td></tr>\n", file);
    }
    fputs("</table></details>\n", file);
}

static void put_experiment(FILE *file, const lab_experiment *experiment)
{
    char place[160];
    fprintf(file, "<h2 id=\"%s\">", experiment->name);
    lab_put_escaped(file, place_of(experiment, place));
    fputs(": ", file);
    lab_put_escaped(file, experiment->doc);
    fprintf(file, "</h2>\n<p><code>pellicle reproduce %s</code> (%.0f s)</p>\n", experiment->name, experiment->seconds);
    put_claims(file, experiment);
    put_tables(file, experiment);
    for (int i = 0; i < experiment->image_count; i++) {
        fprintf(file, "<figure><img loading=\"lazy\" src=\"%s/%s\" alt=\"\"><figcaption>", experiment->name,
                experiment->images[i].file);
        lab_put_escaped(file, experiment->images[i].caption);
        fputs("</figcaption></figure>\n", file);
    }
    put_numbers(file, experiment);
}

static void write_html(FILE *file, const void *context)
{
    const page *all = context;
    fprintf(file, "%s<p>", head);
    put_counts(file, all);
    fputs("</p>\n<ul>\n", file);
    for (int i = 0; i < all->count; i++) {
        char place[160];
        const lab_experiment *experiment = all->experiments[i];
        const char *verdict = lab_verdict_name(lab_experiment_verdict(experiment));
        fprintf(file, "<li><a href=\"#%s\">", experiment->name);
        lab_put_escaped(file, place_of(experiment, place));
        fputs("</a>: ", file);
        lab_put_escaped(file, experiment->doc);
        fprintf(file, ": <span class=\"%s\">%s</span></li>\n", verdict, verdict);
    }
    fputs("</ul>\n", file);
    for (int i = 0; i < all->count; i++)
        put_experiment(file, all->experiments[i]);
    fputs("</body>\n</html>\n", file);
}

/* ---- Markdown ---- */

static void put_markdown(FILE *file, const lab_experiment *experiment)
{
    char text[2048], place[160];
    fprintf(file,
            "\n## %s: %s\n\n    pellicle reproduce %s\n\n| from | statement | measured (wanted) | verdict |\n"
            "|---|---|---|---|\n",
            place_of(experiment, place), experiment->doc, experiment->name);
    for (int claim = 0; claim < experiment->claim_count; claim++) {
        if (!is_said(experiment, claim))
            continue;
        measured(experiment, claim, text, sizeof text);
        fprintf(file, "| %s | %s | %s | ", lab_origin_name(experiment->claims[claim].origin),
                experiment->claims[claim].says, text);
        fprintf(file, "%s |\n", lab_claim_text(experiment, claim, text, sizeof text));
    }
    for (int i = 0; i < experiment->row_count; i++) {
        const lab_row *row = &experiment->rows[i];
        if (row->is_head)
            fprintf(file, "\n%s:\n\n", row->caption);
        fputs("|", file);
        put_cells(file, row->cells, " ", " |");
        fputs("\n", file);
        if (row->is_head) {
            fputs("|", file);
            for (const char *at = row->cells; at != NULL; at = strchr(at + 1, '|'))
                fputs("---|", file);
            fputs("\n", file);
        }
    }
    for (int k = 0; k < experiment->image_count; k++)
        fprintf(file, "\n![%s](%s/%s)\n", experiment->images[k].caption, experiment->name, experiment->images[k].file);
}

static void write_markdown(FILE *file, const void *context)
{
    const page *all = context;
    fputs("# Reproduction of both papers\n\n", file);
    put_counts(file, all);
    fputs("\n", file);
    for (int i = 0; i < all->count; i++)
        put_markdown(file, all->experiments[i]);
}

/* ---- both ---- */

pel_status lab_write_page(const char *folder, const lab_experiment *const *experiments, int count, pel_error *error)
{
    char path[LAB_PATH_SIZE];
    const page all = {experiments, count};
    snprintf(path, sizeof path, "%s/index.html", folder);
    pel_status status = lab_write_file(path, "page", write_html, &all, error);
    snprintf(path, sizeof path, "%s/index.md", folder);
    return status == PEL_OK ? lab_write_file(path, "page", write_markdown, &all, error) : status;
}
