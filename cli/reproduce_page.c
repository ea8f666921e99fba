/* The page about experiments that ran: a table of verdicts, then each with its claims, numbers and pictures. Once as
   HTML and once as Markdown; both use relative paths, so that the folder can be moved. */
#include "experiment.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* text escaped for HTML */
static void put_html(FILE *file, const char *text)
{
    for (; *text != '\0'; text++) {
        if (*text == '<')
            fputs("&lt;", file);
        else if (*text == '>')
            fputs("&gt;", file);
        else if (*text == '&')
            fputs("&amp;", file);
        else
            fputc(*text, file);
    }
}

/* "name 0.42 <= 0.75" of the numbers that are judged for a claim, some of them */
static void measured(const cli_experiment *experiment, int claim, char *text, size_t size)
{
    enum { MOST = 5 };
    static const char *const relations[] = {"", "=", "<=", ">="};
    int count = 0;
    size_t length = 0;
    text[0] = '\0';
    for (int i = 0; i < experiment->finding_count; i++) {
        const cli_finding *finding = &experiment->findings[i];
        if (finding->claim != claim || finding->relation == CLI_TOLD)
            continue;
        count++;
        if (count > MOST || length + 160 > size)
            continue;
        length += (size_t)snprintf(text + length, size - length, "%s%s %.4g (%s %.4g", count > 1 ? "; " : "",
                                   finding->name, finding->value, relations[finding->relation], finding->expected);
        if (finding->relation == CLI_EQUAL && finding->tolerance > 0)
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

static void put_verdict(FILE *file, const cli_experiment *experiment, int claim)
{
    char text[512];
    fprintf(file, "<span class=\"%s\">", cli_verdict_name(cli_claim_verdict(experiment, claim)));
    put_html(file, cli_claim_text(experiment, claim, text, sizeof text));
    fputs("</span>", file);
}

static bool is_said(const cli_experiment *experiment, int claim)
{
    return cli_claim_verdict(experiment, claim) != CLI_ONLY_TOLD;
}

static void put_table(FILE *file, const cli_experiment *const *experiments, int count)
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
                    experiments[i]->name, cli_origin_name(experiments[i]->claims[claim].origin));
            put_html(file, experiments[i]->claims[claim].says);
            fputs("</td><td>", file);
            measured(experiments[i], claim, text, sizeof text);
            put_html(file, text);
            fputs("</td><td>", file);
            put_verdict(file, experiments[i], claim);
            fputs("</td></tr>\n", file);
        }
    fputs("</table>\n", file);
}

static void put_numbers(FILE *file, const cli_experiment *experiment)
{
    fputs("<details><summary>all numbers</summary>\n<table>\n"
          "<tr><th>number</th><th>value</th><th>wanted</th><th>source</th></tr>\n",
          file);
    for (int i = 0; i < experiment->finding_count; i++) {
        static const char *const relations[] = {"beside ", "", "at most ", "at least "};
        const cli_finding *f = &experiment->findings[i];
        fputs("<tr><td>", file);
        put_html(file, f->name);
        fprintf(file, "</td><td class=\"number\">%.6g</td><td>", f->value);
        if (!isnan(f->expected))
            fprintf(file, "%s%.6g", relations[f->relation], f->expected);
        if (f->relation == CLI_EQUAL && f->tolerance > 0)
            fprintf(file, " &plusmn; %.2g", f->tolerance);
        if (!cli_finding_holds(f))
            fputs(" <span class=\"differs\">(not so)</span>", file);
        fputs("</td><td>", file);
        put_html(file, f->source);
        fputs("</td></tr>\n", file);
    }
    fputs("</table></details>\n", file);
}

static void put_experiment(FILE *file, const cli_experiment *experiment)
{
    fprintf(file, "<h2 id=\"%s\">%s</h2>\n<p>", experiment->name, experiment->name);
    put_html(file, experiment->doc);
    fprintf(file, " (%.0f s)</p>\n<ul>\n", experiment->seconds);
    for (int claim = 0; claim < experiment->claim_count; claim++) {
        if (!is_said(experiment, claim))
            continue;
        fprintf(file, "<li>%s: ", cli_origin_name(experiment->claims[claim].origin));
        put_html(file, experiment->claims[claim].says);
        fputs(": ", file);
        put_verdict(file, experiment, claim);
        fputs("</li>\n", file);
    }
    fputs("</ul>\n", file);
    for (int i = 0; i < experiment->image_count; i++) {
        fprintf(file, "<figure><img loading=\"lazy\" src=\"%s/%s\" alt=\"\"><figcaption>", experiment->name,
                experiment->images[i].file);
        put_html(file, experiment->images[i].caption);
        fputs("</figcaption></figure>\n", file);
    }
    put_numbers(file, experiment);
}

static void write_html(FILE *file, const cli_experiment *const *experiments, int count)
{
    fputs(head, file);
    put_table(file, experiments, count);
    for (int i = 0; i < count; i++)
        put_experiment(file, experiments[i]);
    fputs("</body>\n</html>\n", file);
}

/* ---- Markdown ---- */

static void write_markdown(FILE *file, const cli_experiment *const *experiments, int count)
{
    char text[2048];
    fputs("# Reproduction of both papers\n\n| experiment | from | what it says | measured (wanted) | verdict "
          "|\n|---|---|---|---|---|\n",
          file);
    for (int i = 0; i < count; i++)
        for (int claim = 0; claim < experiments[i]->claim_count; claim++) {
            if (!is_said(experiments[i], claim))
                continue;
            measured(experiments[i], claim, text, sizeof text);
            fprintf(file, "| [%s](#%s) | %s | %s | %s | ", experiments[i]->name, experiments[i]->name,
                    cli_origin_name(experiments[i]->claims[claim].origin), experiments[i]->claims[claim].says, text);
            fprintf(file, "%s |\n", cli_claim_text(experiments[i], claim, text, sizeof text));
        }
    for (int i = 0; i < count; i++) {
        fprintf(file, "\n## %s\n\n%s (%.0f s)\n", experiments[i]->name, experiments[i]->doc, experiments[i]->seconds);
        for (int k = 0; k < experiments[i]->image_count; k++)
            fprintf(file, "\n![%s](%s/%s)\n", experiments[i]->images[k].caption, experiments[i]->name,
                    experiments[i]->images[k].file);
    }
}

/* ---- both ---- */

pel_status cli_reproduce_page(const char *folder, const cli_experiment *const *experiments, int count, pel_error *error)
{
    static const char *const names[2] = {"index.html", "index.md"};
    static void (*const writers[2])(FILE *, const cli_experiment *const *, int) = {write_html, write_markdown};
    for (int i = 0; i < 2; i++) {
        char path[CLI_EXPERIMENT_PATH];
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        FILE *file = fopen(path, "w");
        bool whole = file != NULL;
        if (whole) {
            writers[i](file, experiments, count);
            whole = ferror(file) == 0;
            whole = fclose(file) == 0 && whole;
        }
        if (!whole) {
            pel_fail(error, PEL_BAD_FILE, "the page was not written whole");
            cli_name_file(error, path);
            return PEL_BAD_FILE;
        }
    }
    return PEL_OK;
}
