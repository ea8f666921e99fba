#include "mesh/issue.h"

#include "base/memory.h"

#define FIX "run `pellicle check FILE --fix OUT`"

static const pel_issue_info infos[PEL_ISSUE_COUNT] = {
    {PEL_ISSUE_BAD_INDEX, "bad-index", "triangle", PEL_SEVERITY_ERROR, "triangle with a vertex that does not exist",
     FIX " to drop it, or export the mesh again: the file is damaged", true},
    {PEL_ISSUE_NOT_FINITE, "not-finite", "vertex", PEL_SEVERITY_ERROR,
     "vertex with a coordinate that is NaN or infinite", FIX " to drop it and its triangles, or export the mesh again",
     true},
    {PEL_ISSUE_REPEATED_VERTEX, "repeated-vertex", "triangle", PEL_SEVERITY_ERROR,
     "triangle with the same vertex twice", FIX " to drop it", true},
    {PEL_ISSUE_ZERO_AREA, "zero-area", "triangle", PEL_SEVERITY_ERROR, "triangle without area",
     FIX " to merge it into its neighbour, or to drop it where that is not possible", true},
    {PEL_ISSUE_DUPLICATE_TRIANGLE, "duplicate-triangle", "triangle", PEL_SEVERITY_ERROR,
     "triangle with the same vertices as an earlier one", FIX " to drop it", true},
    {PEL_ISSUE_NON_MANIFOLD_EDGE, "non-manifold-edge", "edge", PEL_SEVERITY_ERROR, "edge in more than two triangles",
     FIX " to cut the pieces apart there", true},
    {PEL_ISSUE_NON_MANIFOLD_VERTEX, "non-manifold-vertex", "vertex", PEL_SEVERITY_ERROR,
     "vertex in which pieces of the surface touch without a common edge", FIX " to give each piece a vertex of its own",
     true},
    {PEL_ISSUE_INCONSISTENT_WINDING, "inconsistent-winding", "edge", PEL_SEVERITY_ERROR,
     "edge between triangles that face opposite sides", FIX " to turn triangles around", true},
    {PEL_ISSUE_NON_ORIENTABLE, "non-orientable", "component", PEL_SEVERITY_ERROR,
     "surface with one side only, like a Moebius strip or a Klein bottle",
     "cut it open along a row of edges in a mesh editor", false},
    {PEL_ISSUE_INSIDE_OUT, "inside-out", "component", PEL_SEVERITY_WARNING,
     "closed surface whose triangles face inward",
     FIX " to turn it outward, unless it is the inner wall of a hollow body", true},
    {PEL_ISSUE_DUPLICATE_VERTEX, "duplicate-vertex", "vertex", PEL_SEVERITY_WARNING,
     "vertex exactly where an earlier one is: the surface may be open there", FIX " to weld them", true},
    {PEL_ISSUE_ISOLATED_VERTEX, "isolated-vertex", "vertex", PEL_SEVERITY_WARNING, "vertex in no triangle",
     FIX " to drop it", true},
    {PEL_ISSUE_BOUNDARY_EDGE, "boundary-edge", "edge", PEL_SEVERITY_NOTE, "edge on the rim of an open surface",
     "if the surface is meant to be closed, run `pellicle check FILE --fix OUT --fill-holes 1000`", false},
};

const pel_issue_info *pel_issue_info_of(pel_issue_kind kind)
{
    return (unsigned)kind < PEL_ISSUE_COUNT ? &infos[kind] : NULL;
}

/* room for one more in both lists: they double at 0, 16, 32, ... elements */
static bool make_room(pel_issue *issue)
{
    enum { LEAST = 16 };
    int32_t count = issue->listed_count;
    if (count > 0 && (count < LEAST || (count & (count - 1)) != 0))
        return true;
    size_t capacity = count < LEAST ? LEAST : 2 * (size_t)count;
    int32_t *elements = pel_reallocate(issue->elements, capacity, sizeof *elements);
    if (elements != NULL)
        issue->elements = elements;
    int32_t(*related)[2] = pel_reallocate(issue->related, capacity, sizeof *related);
    if (related != NULL)
        issue->related = related;
    return elements != NULL && related != NULL;
}

pel_status pel_issue_add(pel_mesh_report *report, pel_issue_kind kind, int32_t element, int32_t a, int32_t b)
{
    pel_issue *issue = &report->issues[kind];
    issue->count++;
    if (issue->listed_count == PEL_ISSUE_LIST_LIMIT)
        return PEL_OK;
    if (!make_room(issue))
        return PEL_OUT_OF_MEMORY;
    issue->elements[issue->listed_count] = element;
    issue->related[issue->listed_count][0] = a;
    issue->related[issue->listed_count][1] = b;
    issue->listed_count++;
    return PEL_OK;
}

void pel_issue_sum(pel_mesh_report *report)
{
    for (int32_t i = 0; i < PEL_ISSUE_COUNT; i++) {
        if (infos[i].severity == PEL_SEVERITY_ERROR)
            report->error_count += report->issues[i].count;
        else if (infos[i].severity == PEL_SEVERITY_WARNING)
            report->warning_count += report->issues[i].count;
    }
}
