/* The page about experiments that ran: a table of verdicts, then each with its claims, numbers and pictures. Once as
   HTML and once as Markdown; both use relative paths, so that the folder can be moved. */
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

/* ---- HTML ---- */

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

static void put_table(FILE *file, const lab_experiment *const *experiments, int count)
{
    char text[2048];
    fputs("<table>\n<tr><th>experiment</th><th>from</th><th>what it says</th><th>measured (wanted)</th>"
          "<th>verdict</th></tr>\n",
          file);
    for (int i = 0; i < count; i++)
        for (int claim = 0; claim < experiments[i]->claim_count; claim++) {
            if (!is_said(experiments[i], claim))
                continue;
            fprintf(file, "<tr><td><a href=\"#%s\">%s</a></td><td>%s</td><td>", experiments[i]->name,
                    experiments[i]->name, lab_origin_name(experiments[i]->claims[claim].origin));
            lab_put_escaped(file, experiments[i]->claims[claim].says);
            fputs("</td><td>", file);
            measured(experiments[i], claim, text, sizeof text);
            lab_put_escaped(file, text);
            fputs("</td><td>", file);
            put_verdict(file, experiments[i], claim);
            fputs("</td></tr>\n", file);
        }
    fputs("</table>\n", file);
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
    fprintf(file, "<h2 id=\"%s\">%s</h2>\n<p>", experiment->name, experiment->name);
    lab_put_escaped(file, experiment->doc);
    fprintf(file, " (%.0f s)</p>\n<ul>\n", experiment->seconds);
    for (int claim = 0; claim < experiment->claim_count; claim++) {
        if (!is_said(experiment, claim))
            continue;
        fprintf(file, "<li>%s: ", lab_origin_name(experiment->claims[claim].origin));
        lab_put_escaped(file, experiment->claims[claim].says);
        fputs(": ", file);
        put_verdict(file, experiment, claim);
        fputs("</li>\n", file);
    }
    fputs("</ul>\n", file);
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
    fputs(head, file);
    put_table(file, all->experiments, all->count);
    for (int i = 0; i < all->count; i++)
        put_experiment(file, all->experiments[i]);
    fputs("</body>\n</html>\n", file);
}

/* ---- Markdown ---- */

static void write_markdown(FILE *file, const void *context)
{
    const page *all = context;
    const lab_experiment *const *experiments = all->experiments;
    char text[2048];
    fputs("# Reproduction of both papers\n\n| experiment | from | what it says | measured (wanted) | verdict "
          "|\n|---|---|---|---|---|\n",
          file);
    for (int i = 0; i < all->count; i++)
        for (int claim = 0; claim < experiments[i]->claim_count; claim++) {
            if (!is_said(experiments[i], claim))
                continue;
            measured(experiments[i], claim, text, sizeof text);
            fprintf(file, "| [%s](#%s) | %s | %s | %s | ", experiments[i]->name, experiments[i]->name,
                    lab_origin_name(experiments[i]->claims[claim].origin), experiments[i]->claims[claim].says, text);
            fprintf(file, "%s |\n", lab_claim_text(experiments[i], claim, text, sizeof text));
        }
    for (int i = 0; i < all->count; i++) {
        fprintf(file, "\n## %s\n\n%s (%.0f s)\n", experiments[i]->name, experiments[i]->doc, experiments[i]->seconds);
        for (int k = 0; k < experiments[i]->image_count; k++)
            fprintf(file, "\n![%s](%s/%s)\n", experiments[i]->images[k].caption, experiments[i]->name,
                    experiments[i]->images[k].file);
    }
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
