/* The report of a study: one HTML page without a network. Parallel coordinates (Inselberg, The Visual Computer 1,
   1985), a scatter plot, and picked runs side by side. */
#include "io/file.h"
#include "study/study.h"

#include <string.h>

/* clang-format off */
/* before and behind the data */
static const char *const page_head[] = {
    "<!DOCTYPE html>\n",
    "<html lang=\"en\">\n",
    "<head>\n",
    "<meta charset=\"utf-8\">\n",
    "<title>Pellicle study</title>\n",
    "<style>\n",
    "body { font: 14px/1.4 sans-serif; margin: 1.5em auto; max-width: 1200px; padding: 0 1em; color: #222; }\n",
    "h1 { font-size: 20px; } h2 { font-size: 15px; margin: 1.4em 0 0.3em; }\n",
    "svg { width: 100%; background: #fafafa; border: 1px solid #ddd; } .hint, .failed { color: #666; }\n",
    "table { border-collapse: collapse; font-variant-numeric: tabular-nums; }\n",
    "td, th { border-bottom: 1px solid #ddd; padding: 2px 8px; text-align: right; }\n",
    "td:first-child, th:first-child { text-align: left; }\n",
    ".line { fill: none; stroke-width: 1.2; opacity: 0.55; } .off { opacity: 0.06; stroke: #888; }\n",
    ".picked { stroke-width: 3.5; opacity: 1; } .dot { opacity: 0.75; cursor: pointer; }\n",
    ".axis { stroke: #555; } .brush { fill: #1f6fb4; opacity: 0.2; } text { font-size: 11px; fill: #333; }\n",
    "#rows { max-height: 22em; overflow: auto; } #rows tr { cursor: pointer; } tr.mark { background: #fff2c4; }\n",
    "</style>\n",
    "</head>\n",
    "<body>\n",
    "<h1 id=\"title\"></h1>\n",
    "<p id=\"count\"></p>\n",
    "<p>Color: <select id=\"color\"></select></p>\n",
    "<h2>Parallel coordinates</h2>\n",
    "<p class=\"hint\">Drag along an axis to select a range; click the axis to clear it. Click a line to pick its run.</p>\n",
    "<svg id=\"parallel\" viewBox=\"0 0 1160 330\"></svg>\n",
    "<h2>Scatter</h2>\n",
    "<p>x: <select id=\"x\"></select> y: <select id=\"y\"></select></p>\n",
    "<svg id=\"scatter\" viewBox=\"0 0 1160 380\"></svg>\n",
    "<h2>Runs side by side</h2>\n",
    "<p class=\"hint\" id=\"hint\">Pick runs in the pictures or in the table below.</p>\n",
    "<table id=\"side\"></table>\n",
    "<h2>All selected runs</h2>\n",
    "<div id=\"rows\"><table id=\"table\"></table></div>\n",
    "<script>\n",
};

static const char *const page_tail[] = {
    "'use strict';\n",
    "const byId = (id) => document.getElementById(id);\n",
    "const make = (name, attributes, parent) => {\n",
    "  const node = document.createElementNS('http://www.w3.org/2000/svg', name);\n",
    "  for (const key in attributes) node.setAttribute(key, attributes[key]);\n",
    "  return parent.appendChild(node);\n",
    "};\n",
    "// a line of the table to its cells\n",
    "const cells = (line) => {\n",
    "  const found = [];\n",
    "  for (let i = 0; i <= line.length; i++) {\n",
    "    let text = '';\n",
    "    if (line[i] === '\"') {\n",
    "      for (i++; i < line.length; i++) {\n",
    "        if (line[i] !== '\"') text += line[i];\n",
    "        else if (line[i + 1] === '\"') text += line[i++];\n",
    "        else break;\n",
    "      }\n",
    "      i++;\n",
    "    } else {\n",
    "      const end = line.indexOf(',', i) < 0 ? line.length : line.indexOf(',', i);\n",
    "      text = line.slice(i, end);\n",
    "      i = end;\n",
    "    }\n",
    "    found.push(text);\n",
    "  }\n",
    "  return found;\n",
    "};\n",
    "const names = cells(study.header);\n",
    "const rows = study.rows.map(cells);\n",
    "const statusColumn = names.length - 2;\n",
    "// a column of texts has its values as ticks\n",
    "const columns = names.slice(1, statusColumn).map((name, i) => {\n",
    "  const texts = rows.map((row) => row[i + 1]);\n",
    "  const isNumber = texts.some((t) => t !== '') && texts.every((t) => t === '' || isFinite(Number(t)));\n",
    "  const words = isNumber ? null : [...new Set(texts)];\n",
    "  const values = texts.map((t) => (t === '' ? NaN : isNumber ? Number(t) : words.indexOf(t)));\n",
    "  const finite = values.filter(isFinite);\n",
    "  let low = Math.min(...finite), high = Math.max(...finite);\n",
    "  if (finite.length === 0) { low = 0; high = 1; }\n",
    "  if (low === high) { low -= Math.abs(low) * 0.01 + 1e-12; high += Math.abs(high) * 0.01 + 1e-12; }\n",
    "  return { name, values, texts, words, low, high, brush: null, isInput: i < study.inputs };\n",
    "});\n",
    "const unit = (c, v) => (v - c.low) / (c.high - c.low);\n",
    "const format = (c, v) => (c.words ? c.words[Math.round(v)] || '' : String(Number(v.toPrecision(5))));\n",
    "const picked = new Set();\n",
    "const done = rows.map((row) => row[statusColumn] === 'done');\n",
    "const failed = done.filter((d) => !d).length;\n",
    "byId('title').textContent = 'Study ' + study.name;\n",
    "byId('count').textContent = rows.length + ' runs of ' + study.scene + (failed ? ', ' + failed + ' failed' : '');\n",
    "for (const id of ['color', 'x', 'y'])\n",
    "  columns.forEach((c, i) => byId(id).add(new Option(c.name, i)));\n",
    "byId('color').value = byId('y').value = Math.min(study.inputs, columns.length - 1);\n",
    "byId('x').value = 0;\n",
    "// viridis, coarsely\n",
    "const stops = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [230, 210, 40]];\n",
    "const colorOf = (r) => {\n",
    "  const c = columns[byId('color').value], u = unit(c, c.values[r]);\n",
    "  if (!isFinite(u)) return '#bbb';\n",
    "  const at = Math.min(3, Math.floor(u * 4)), part = u * 4 - at;\n",
    "  return 'rgb(' + stops[at].map((a, i) => Math.round(a + (stops[at + 1][i] - a) * part)) + ')';\n",
    "};\n",
    "const selected = (r) => columns.every((c) => !c.brush || (c.values[r] >= c.brush[0] && c.values[r] <= c.brush[1]));\n",
    "const pick = (r) => { if (!picked.delete(r)) picked.add(r); draw(); };\n",
    "function drawParallel() {\n",
    "  const svg = byId('parallel'), top = 45, bottom = 300, step = 1040 / Math.max(1, columns.length - 1);\n",
    "  const place = (i) => 60 + i * step;\n",
    "  const height = (c, v) => bottom - unit(c, v) * (bottom - top);\n",
    "  svg.replaceChildren();\n",
    "  rows.forEach((_, r) => {\n",
    "    const points = columns.map((c, i) => [place(i), height(c, c.values[r])]).filter((p) => isFinite(p[1]));\n",
    "    const kind = picked.has(r) ? 'line picked' : selected(r) ? 'line' : 'line off';\n",
    "    const line = make('polyline', { points: points.join(' '), class: kind, stroke: colorOf(r) }, svg);\n",
    "    line.addEventListener('click', () => pick(r));\n",
    "    make('title', {}, line).textContent = 'run ' + r;\n",
    "  });\n",
    "  columns.forEach((c, i) => {\n",
    "    make('line', { x1: place(i), x2: place(i), y1: top, y2: bottom, class: 'axis' }, svg);\n",
    "    if (c.brush) {\n",
    "      const y = height(c, c.brush[1]);\n",
    "      make('rect', { x: place(i) - 7, width: 14, y, height: height(c, c.brush[0]) - y, class: 'brush' }, svg);\n",
    "    }\n",
    "    const side = i === 0 ? 'start' : i === columns.length - 1 ? 'end' : 'middle';\n",
    "    const anchor = { x: place(i) + (side === 'start' ? -50 : side === 'end' ? 50 : 0), 'text-anchor': side };\n",
    "    const label = make('text', { ...anchor, y: i % 2 ? 14 : 28, 'font-weight': c.isInput ? 'normal' : 'bold' }, svg);\n",
    "    label.textContent = c.name.length > 26 ? '\\u2026' + c.name.slice(-25) : c.name;\n",
    "    make('title', {}, label).textContent = c.name;\n",
    "    make('text', { ...anchor, y: top - 4 }, svg).textContent = format(c, c.high);\n",
    "    make('text', { ...anchor, y: bottom + 14 }, svg).textContent = format(c, c.low);\n",
    "    const grip = make('rect', { x: place(i) - 12, width: 24, y: top, height: bottom - top, opacity: 0 }, svg);\n",
    "    grip.addEventListener('pointerdown', (down) => {\n",
    "      const scale = 330 / svg.getBoundingClientRect().height;\n",
    "      const value = (e) => {\n",
    "        const y = (e.clientY - svg.getBoundingClientRect().top) * scale;\n",
    "        return c.low + Math.min(1, Math.max(0, (bottom - y) / (bottom - top))) * (c.high - c.low);\n",
    "      };\n",
    "      const first = value(down);\n",
    "      c.brush = null;\n",
    "      const move = (e) => {\n",
    "        const second = value(e);\n",
    "        if (Math.abs(e.clientY - down.clientY) > 3) c.brush = [Math.min(first, second), Math.max(first, second)];\n",
    "      };\n",
    "      addEventListener('pointerup', (e) => { move(e); draw(); }, { once: true });\n",
    "    });\n",
    "  });\n",
    "}\n",
    "function drawScatter() {\n",
    "  const svg = byId('scatter'), cx = columns[byId('x').value], cy = columns[byId('y').value];\n",
    "  svg.replaceChildren();\n",
    "  make('path', { d: 'M80 20V340H1130', fill: 'none', class: 'axis' }, svg);\n",
    "  for (let k = 0; k <= 4; k++) {\n",
    "    const vx = cx.low + (k / 4) * (cx.high - cx.low), vy = cy.low + (k / 4) * (cy.high - cy.low);\n",
    "    make('text', { x: 80 + k * 260, y: 356, 'text-anchor': 'middle' }, svg).textContent = format(cx, vx);\n",
    "    make('text', { x: 74, y: 344 - k * 80, 'text-anchor': 'end' }, svg).textContent = format(cy, vy);\n",
    "  }\n",
    "  make('text', { x: 600, y: 374, 'text-anchor': 'middle' }, svg).textContent = cx.name;\n",
    "  make('text', { x: 84, y: 14 }, svg).textContent = cy.name;\n",
    "  rows.forEach((_, r) => {\n",
    "    const x = 80 + unit(cx, cx.values[r]) * 1040, y = 340 - unit(cy, cy.values[r]) * 320;\n",
    "    if (!isFinite(x + y) || !selected(r)) return;\n",
    "    const dot = make('circle', { cx: x, cy: y, r: picked.has(r) ? 8 : 4.5, class: 'dot', fill: colorOf(r) }, svg);\n",
    "    dot.addEventListener('click', () => pick(r));\n",
    "    make('title', {}, dot).textContent = 'run ' + r;\n",
    "  });\n",
    "}\n",
    "function addRow(table, texts, tag) {\n",
    "  const row = table.insertRow();\n",
    "  for (const text of texts) row.appendChild(document.createElement(tag)).textContent = text;\n",
    "  return row;\n",
    "}\n",
    "function drawTables() {\n",
    "  const side = byId('side'), table = byId('table'), runs = [...picked].sort((a, b) => a - b);\n",
    "  side.replaceChildren();\n",
    "  if (runs.length)\n",
    "    names.forEach((name, i) => addRow(side, [name, ...runs.map((r) => rows[r][i])], i ? 'td' : 'th'));\n",
    "  byId('hint').textContent = runs.length && study.keep\n",
    "    ? 'Their surfaces: pellicle report ' + runs.map((r) => 'runs/' + String(r).padStart(5, '0')).join(' ') + ' -o side.html'\n",
    "    : 'Pick runs in the pictures or in the table below.';\n",
    "  table.replaceChildren();\n",
    "  addRow(table, names, 'th');\n",
    "  rows.forEach((row, r) => {\n",
    "    if (!selected(r)) return;\n",
    "    const line = addRow(table, row, 'td');\n",
    "    line.className = picked.has(r) ? 'mark' : done[r] ? '' : 'failed';\n",
    "    line.addEventListener('click', () => pick(r));\n",
    "  });\n",
    "}\n",
    "function draw() { drawParallel(); drawScatter(); drawTables(); }\n",
    "for (const id of ['color', 'x', 'y']) byId(id).addEventListener('change', draw);\n",
    "draw();\n",
    "</script>\n",
    "</body>\n",
    "</html>\n",
};
/* clang-format on */

static void put_lines(pel_file_writer *writer, const char *const *lines, size_t count)
{
    for (size_t i = 0; i < count; i++)
        pel_file_writer_write(writer, lines[i], strlen(lines[i]));
}

static void put_string(pel_file_writer *writer, pel_json *json, const char *text)
{
    json->length = 0;
    pel_json_put_text(json, text);
    if (!json->failed)
        pel_file_writer_write(writer, json->text, json->length);
}

static const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

static void put_data(pel_study_page *page, const pel_study *study)
{
    pel_file_writer *writer = &page->writer;
    pel_file_writer_printf(writer, "const study = {inputs: %d, keep: %s, name: ", (int)study->axis_count,
                           study->keep ? "true" : "false");
    put_string(writer, &page->json, file_name(study->path));
    pel_file_writer_printf(writer, ", scene: ");
    put_string(writer, &page->json, study->scene_name);
    pel_file_writer_printf(writer, ",\nheader: ");
    put_string(writer, &page->json, study->header);
    pel_file_writer_printf(writer, ",\nrows: [");
}

pel_status pel_study_page_open(pel_study_page *page, const pel_study *study, const char *path, pel_error *error)
{
    *page = (pel_study_page){.row_count = 0};
    pel_status status = pel_file_writer_open(&page->writer, path, error);
    if (status != PEL_OK)
        return status;
    put_lines(&page->writer, page_head, sizeof page_head / sizeof *page_head);
    put_data(page, study);
    return PEL_OK;
}

void pel_study_page_put(pel_study_page *page, const char *row)
{
    pel_file_writer_printf(&page->writer, page->row_count++ > 0 ? ",\n" : "\n");
    put_string(&page->writer, &page->json, row);
}

void pel_study_page_abandon(pel_study_page *page)
{
    pel_json_free(&page->json);
    pel_file_writer_abandon(&page->writer);
}

pel_status pel_study_page_commit(pel_study_page *page, pel_error *error)
{
    pel_file_writer_printf(&page->writer, "]};\n");
    put_lines(&page->writer, page_tail, sizeof page_tail / sizeof *page_tail);
    if (page->json.failed) {
        pel_study_page_abandon(page);
        return pel_fail_memory(error);
    }
    pel_json_free(&page->json);
    return pel_file_writer_commit(&page->writer, error);
}
