#define _DEFAULT_SOURCE /* realpath */
#include "commands.h"
#include "diagnostics.h"
#include "stop.h"

#include <pellicle/study.h>

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SWEEP_PATH = 4096 };

/* tasks of a job array when --chunks does not say */
enum { SLURM_CHUNKS = 16 };

/* the progress line of a terminal */
typedef struct display {
    bool shown;
    double last; /* s, when it was written; 0 = never */
} display;

static void show_progress(void *user, const pel_study_progress *p)
{
    display *d = user;
    double now = pel_seconds();
    if (now - d->last < 0.1 && p->done < p->total)
        return;
    d->last = now;
    fprintf(stderr, "\r\033[Krun %lld/%lld", (long long)p->done, (long long)p->total);
    if (p->failed > 0)
        fprintf(stderr, "  %lld failed", (long long)p->failed);
    if (p->remaining >= 0) {
        long left = (long)(p->remaining + 0.5);
        fprintf(stderr, "  ETA %ld:%02ld", left / 60, left % 60);
    }
    fflush(stderr);
}

static bool is_wanted(void *user)
{
    (void)user;
    return !cli_stop_asked();
}

/* --chunk k/n */
static bool read_chunk(const char *text, pel_study_def *def)
{
    char *end;
    if (text == NULL)
        return true;
    long chunk = strtol(text, &end, 10), count = 0;
    bool has_count = end > text && *end == '/';
    if (has_count) {
        const char *second = end + 1;
        count = strtol(second, &end, 10);
        has_count = end > second && *end == '\0';
    }
    if (!has_count || chunk < 1 || chunk > count || count > INT_MAX)
        return cli_complain("--chunk %s: there is no such chunk. write --chunk 3/16 for the third of 16", text), false;
    def->chunk = (int32_t)chunk;
    def->chunk_count = (int32_t)count;
    return true;
}

/* -o, else results/ and the study's name */
static bool choose_folder(const cli_call *call, char folder[SWEEP_PATH])
{
    const char *given = cli_value(call, "output"), *path = call->arguments[0];
    const char *slash = strrchr(path, '/'), *name = slash != NULL ? slash + 1 : path, *dot = strrchr(name, '.');
    int length = given != NULL ? snprintf(folder, SWEEP_PATH, "%s", given)
                               : snprintf(folder, SWEEP_PATH, "results/%.*s",
                                          dot != NULL && dot != name ? (int)(dot - name) : (int)strlen(name), name);
    if (length < 0 || length >= SWEEP_PATH)
        return cli_complain("the path of the output folder is too long. choose a shorter one with -o"), false;
    while (length > 1 && folder[length - 1] == '/')
        folder[--length] = '\0';
    return true;
}

static void write_json(const cli_call *call, const pel_study_summary *s, const char *folder)
{
    pel_json json = {.file = stdout, .style = PEL_JSON_INDENTED};
    pel_json_open(&json, NULL, '{');
    pel_json_text(&json, "study", call->arguments[0]);
    pel_json_text(&json, "folder", folder);
    pel_json_integer(&json, "runs", s->runs);
    pel_json_integer(&json, "present", s->present);
    pel_json_integer(&json, "done", s->done);
    pel_json_integer(&json, "failed", s->failed);
    pel_json_integer(&json, "missing", s->missing);
    pel_json_text(&json, "zeros", s->zeros);
    pel_json_text(&json, "warnings", s->warnings);
    pel_json_close(&json, '}');
}

static void print_summary(const pel_study_summary *s, const char *folder)
{
    printf("%lld runs done, %lld were done before, %lld of %lld missing\n", (long long)s->done, (long long)s->present,
           (long long)s->missing, (long long)s->runs);
    if (s->failed > 0)
        printf("%lld runs failed: their rows have the status and the error; --retry repeats them\n",
               (long long)s->failed);
    if (s->zeros[0] != '\0')
        printf("0 in all runs: %s. check that the tool touches the body and that the load acts\n", s->zeros);
    if (s->warnings[0] != '\0')
        printf("warnings: %s. docs/results.md explains them, and pellicle run gives the text for the values of a run\n",
               s->warnings);
    if (s->missing == 0) {
        printf("results in %s:\n", folder);
        printf("  runs.csv      one row for each run\n");
        printf("  report.html   plots of the table, for a browser\n");
    } else {
        printf("the table is written when no run is missing\n");
    }
}

/* ---- Slurm ---- */

/* a path in single quotes of the shell */
static void put_quoted(FILE *file, const char *text)
{
    fputc('\'', file);
    for (; *text != '\0'; text++)
        fputs(*text == '\'' ? "'\\''" : (char[]){*text, '\0'}, file);
    fputc('\'', file);
}

/* a path in an #SBATCH line, where % begins a pattern */
static void put_pattern(FILE *file, const char *text)
{
    for (; *text != '\0'; text++) {
        if (*text == '"' || *text == '\\' || *text == '%')
            fputc(*text == '%' ? '%' : '\\', file);
        fputc(*text, file);
    }
}

/* a line end in a name would begin a line of the job */
static bool has_control(const char *text)
{
    for (; *text != '\0'; text++)
        if ((unsigned char)*text < ' ' || *text == 0x7f)
            return true;
    return false;
}

static bool write_job(const cli_call *call, const char *job, const char *study, const char *folder, int chunks)
{
    char program[SWEEP_PATH] = "pellicle";
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    if (length > 0)
        program[length] = '\0';
    FILE *file = fopen(job, "w");
    if (file == NULL)
        return false;
    fprintf(file, "#!/bin/sh\n#SBATCH --job-name=pellicle\n#SBATCH --array=1-%d\n#SBATCH --output=", chunks);
    fputc('"', file);
    put_pattern(file, folder);
    fputs("/slurm-%a.log\"\n", file);
    fputs("# options of yours go to sbatch on the command line, or here: #SBATCH --time=1:00:00\nexec ", file);
    put_quoted(file, program);
    fputs(" sweep ", file);
    put_quoted(file, study);
    fputs(" -o ", file);
    put_quoted(file, folder);
    fprintf(file, " --chunk \"$SLURM_ARRAY_TASK_ID/%d\" --jobs \"${SLURM_CPUS_PER_TASK:-1}\" --quiet", chunks);
    if (cli_has(call, "timeout")) {
        fputs(" --timeout ", file);
        put_quoted(file, cli_value(call, "timeout"));
    }
    fputs(cli_has(call, "retry") ? " --retry\n" : "\n", file);
    bool whole = ferror(file) == 0;
    return fclose(file) == 0 && whole;
}

/* the exit status of `sbatch job` */
static int submit(const char *job)
{
    int status;
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        execlp("sbatch", "sbatch", job, (char *)NULL);
        _exit(127);
    }
    if (child < 0 || waitpid(child, &status, 0) < 0 || !WIFEXITED(status))
        return -1;
    return WEXITSTATUS(status);
}

/* the folder and the job as absolute paths: a job may start elsewhere */
static int run_slurm(const cli_call *call, const pel_study *study, const char *folder)
{
    char place[PATH_MAX], file[PATH_MAX], job[PATH_MAX + 16];
    int64_t runs = pel_study_run_count(study);
    int chunks = cli_has(call, "chunks") ? cli_count(call, "chunks") : SLURM_CHUNKS;
    if (chunks > runs)
        chunks = (int)runs;
    /* creates the folder, and refuses one of another study */
    pel_study_store *store;
    pel_error error;
    int64_t missing = 0, failed = 0;
    pel_status status = pel_study_store_open(study, folder, 1, 1, &store, &error);
    if (status == PEL_OK)
        status = pel_study_store_collect(store, &missing, &failed, &error);
    pel_study_store_close(store);
    if (status != PEL_OK)
        return cli_report(&error);
    if (cli_has(call, "retry"))
        missing += failed;
    if (missing == 0) {
        printf("no run is missing: %s/runs.csv\n", folder);
        return CLI_DONE;
    }
    if (realpath(folder, place) == NULL || realpath(call->arguments[0], file) == NULL)
        return cli_complain("%s: %s. choose another folder with -o", folder, strerror(errno));
    if (has_control(place) || has_control(file))
        return cli_complain("the path of the study or of its folder has a control character, which a job cannot name. "
                            "rename it");
    snprintf(job, sizeof job, "%s/job.sh", place);
    if (!write_job(call, job, file, place, chunks)) {
        cli_complain("%s: cannot write the job: %s", job, strerror(errno));
        return CLI_FAILED;
    }
    int code = submit(job);
    if (code == 127) {
        cli_complain("the job is written, but there is no program sbatch. submit it with sbatch where Slurm is: %s",
                     job);
        return CLI_FAILED;
    }
    if (code != 0) {
        cli_complain("sbatch refused the job. see its message above, then submit it with sbatch: %s", job);
        return CLI_FAILED;
    }
    if (!cli_has(call, "quiet"))
        printf("%lld runs in %d tasks; the last one to end writes %s/runs.csv\n", (long long)missing, chunks, folder);
    return CLI_DONE;
}

/* ---- here ---- */

static int run_here(const cli_call *call, const pel_study *study, pel_study_def *def)
{
    bool as_json = cli_has(call, "json"), quiet = as_json || cli_has(call, "quiet");
    display d = {.shown = !quiet && isatty(STDERR_FILENO) != 0};
    pel_study_summary summary;
    pel_error error;
    def->thread_count = cli_count(call, "jobs");
    def->run_seconds = cli_has(call, "timeout") ? cli_number(call, "timeout") : 0;
    def->retry = cli_has(call, "retry");
    def->progress = d.shown ? show_progress : NULL;
    def->wanted = is_wanted;
    def->user = &d;
    cli_catch_stop(quiet ? "" : "stopping; the same command continues\n");
    pel_status status = pel_study_execute(study, def, &summary, &error);
    if (d.last > 0)
        fputs("\r\033[K", stderr);
    if (as_json && summary.runs > 0)
        write_json(call, &summary, def->folder);
    else if (!quiet && summary.runs > 0)
        print_summary(&summary, def->folder);
    if (status == PEL_OK)
        return CLI_DONE;
    if (status == PEL_STOPPED)
        pel_fail_remedy(&error, "the same command continues");
    return status == PEL_STOPPED ? (cli_report(&error), CLI_FAILED) : cli_report(&error);
}

int cli_sweep(const cli_call *call)
{
    char folder[SWEEP_PATH];
    pel_study *study;
    pel_error error;
    pel_study_def def = pel_study_def_default();
    if (!choose_folder(call, folder) || !read_chunk(cli_value(call, "chunk"), &def))
        return CLI_BAD_INPUT;
    if (cli_has(call, "slurm") && cli_has(call, "chunk"))
        return cli_complain("--slurm makes the chunks itself. leave out --chunk");
    if (cli_has(call, "chunks") && !cli_has(call, "slurm"))
        return cli_complain("--chunks goes with --slurm. do one chunk with --chunk 3/16");
    if (pel_study_load(call->arguments[0], &study, &error) != PEL_OK)
        return cli_report(&error);
    def.folder = folder;
    int status = cli_has(call, "slurm") ? run_slurm(call, study, folder) : run_here(call, study, &def);
    pel_study_destroy(study);
    return status;
}
