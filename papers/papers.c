#include "papers/papers.h"

#include "papers/a/cases.h"
#include "papers/b/cases.h"
#include "papers/lab/body.h"
#include "papers/lab/page.h"
#include "papers/own/cases.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static const lab_case *const cases[] = {
    &a_rates,    &a_figure_4,     &a_figure_6_7,   &a_table_1,   &a_figure_8,  &a_figure_9,     &a_precision,
    &b_figure_1, &b_figure_2,     &b_figure_4,     &b_figure_5,  &b_figure_6,  &b_algorithm,    &b_figure_8,
    &b_figure_9, &b_figure_10,    &b_figure_11,    &b_figure_12, &b_figure_13, &b_figure_14,    &b_figure_15,
    &b_table_1,  &b_figure_16_18, &b_figure_19_20, &b_table_2,   &b_inflation, &b_exaggeration, &own_refinement,
    &own_shells, &own_validation, &own_tear,
};

enum { CASE_COUNT = sizeof cases / sizeof *cases };

struct papers {
    papers_def def;
    lab_body bodies[LAB_BODIES];
    int body_count;
    lab_experiment *done[CASE_COUNT]; /* (done_count) */
    char folders[CASE_COUNT][LAB_PATH_SIZE];
    int done_count;
};

const lab_case *papers_case_at(int index)
{
    return index < CASE_COUNT ? cases[index] : NULL;
}

/* makes a folder with its parents */
static pel_status make_folder(char *path, pel_error *error)
{
    for (char *slash = path + 1;; slash++) {
        if (*slash != '/' && *slash != '\0')
            continue;
        char kept = *slash;
        *slash = '\0';
        bool made = mkdir(path, 0777) == 0 || errno == EEXIST;
        *slash = kept;
        if (!made) {
            pel_fail(error, PEL_BAD_FILE, "cannot make the folder");
            pel_fail_place(error, path, 0, 0);
            return PEL_BAD_FILE;
        }
        if (kept == '\0')
            return PEL_OK;
    }
}

pel_status papers_create(const papers_def *def, papers **made, pel_error *error)
{
    papers *all = *made = calloc(1, sizeof *all);
    if (all == NULL)
        return pel_fail_memory(error);
    all->def = *def;
    char folder[LAB_PATH_SIZE];
    snprintf(folder, sizeof folder, "%s/bodies", def->folder);
    /* bodies of their own are made there */
    pel_status status = def->mesh == NULL ? make_folder(folder, error) : PEL_OK;
    return status == PEL_OK
               ? lab_find_bodies(folder, def->mesh, def->up, def->data, all->bodies, &all->body_count, error)
               : status;
}

void papers_destroy(papers *all)
{
    if (all == NULL)
        return;
    for (int i = 0; i < all->done_count; i++) {
        lab_clear(all->done[i]);
        free(all->done[i]);
    }
    lab_free_bodies(all->bodies);
    free(all);
}

pel_status papers_run(papers *all, const lab_case *which, const lab_experiment **experiment, pel_error *error)
{
    if (all->done_count == CASE_COUNT)
        return pel_fail(error, PEL_BAD_ARGUMENT, "all %d experiments have run", (int)CASE_COUNT);
    lab_experiment *made = calloc(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    char *folder = all->folders[all->done_count];
    all->done[all->done_count++] = made;
    *experiment = made;
    snprintf(folder, LAB_PATH_SIZE, "%s/%s", all->def.folder, which->name);
    *made = (lab_experiment){.folder = folder,
                             .error = error,
                             .bodies = all->bodies,
                             .body_count = all->body_count,
                             .given_bodies = strcmp(which->group, "paper B") == 0 &&
                                             (all->def.mesh != NULL || all->def.data != NULL),
                             .progress = all->def.progress,
                             .user = all->def.user};
    pel_status status = make_folder(folder, error);
    return status == PEL_OK ? lab_run_case(which, made) : status;
}

pel_status papers_write_page(const papers *all, pel_error *error)
{
    return lab_write_page(all->def.folder, (const lab_experiment *const *)all->done, all->done_count, error);
}
