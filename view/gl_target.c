/* One framebuffer with four samples per pixel and one without, into which it is resolved to be read. The context comes
   from EGL's surfaceless platform (Mesa), which needs neither a display nor a window system.

   Light: a key light whose shadows are sharp enough to read (one depth map, sampled per pixel) and sky light from SKY
   directions around the body (one small depth map each, sampled per vertex). The visible share of the sky at a vertex
   is its ambient occlusion; it depends on the surface alone, so it neither flickers nor has noise. */
#include "view/gl_target.h"

#include "view/support.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 4, COLOR_STEPS = 256, SKY = 24, SKY_SIZE = 192, KEY_SIZE = 1024 };
/* corners per draw call: some tenths of a second in software */
enum { PORTION = 3 * 50000 };

/* one for surfaces without edges, one with: software runs both sides of a branch, and edges cost as much as the light;
   one for shadows on the ground; one for outlines; one for depth maps */
enum { PROGRAM_PLAIN, PROGRAM_EDGES, PROGRAM_GROUND, PROGRAM_OUTLINE, PROGRAM_DEPTH, PROGRAM_COUNT };

typedef struct program {
    GLuint id;
    GLint projection, plain, colored, highlight, edge_width, edge_strength, occlusion;
    GLint key_space, ground_space, sky_spaces, sky_weights, offset, size, outline_width;
} program;

/* from the axes of the camera to a depth map: column by column, x, y and depth in -1 .. 1 */
typedef struct light_space {
    float matrix[16];
} light_space;

struct view_gl_target {
    EGLDisplay display;
    EGLContext context;
    int32_t width, height;
    program programs[PROGRAM_COUNT];
    GLuint corners, layout, color_map;
    GLuint light_framebuffer, key_map,
        sky_maps; /* depth: KEY_SIZE squared; SKY + 1 layers of SKY_SIZE squared, the last from above */
    float up[3];  /* of the world, along the axes of the camera */
    GLuint framebuffers[2], renderbuffers[3]; /* with samples, resolved; color, depth, resolved color */
    uint8_t *pixels;                          /* (height x width x 4) as OpenGL gives them, bottom row first */
    float projection[16];
    view_color background;
    int32_t low[2], high[2];    /* the part that was drawn on, from the lower left corner; empty when low >= high */
    bool (*wanted)(void *user); /* null = always */
    void *user;
    bool is_stopped; /* nothing more is drawn */
    char renderer[128];
};

/* ---- programs ---- */

/* the directions of the sky lie on a Fibonacci spiral, those below the horizon count half; an outline is the far side
   of the surface, pushed outward along its normals by some pixels */
static const char vertex_source[] =
    "layout(location = 0) in vec3 position;\n"
    "layout(location = 1) in vec3 normal;\n"
    "layout(location = 2) in float value;\n"
    "uniform mat4 projection;\n"
    "#ifdef DEPTH\n"
    "void main() { gl_Position = projection * vec4(position, 1.0); }\n"
    "#elif defined(OUTLINE)\n"
    "uniform vec2 size;\n" /* pixels of the picture */
    "uniform float outline_width;\n"
    "void main() {\n"
    "    gl_Position = projection * vec4(position, 1.0);\n"
    "    vec2 outward = normal.xy / max(length(normal.xy), 1e-20);\n"
    "    gl_Position.xy += 2.0 * outline_width * gl_Position.w * outward / size;\n"
    "}\n"
    "#else\n"
    "const int SKY = 24;\n"
    "uniform mat4 key_space, ground_space, sky_spaces[SKY];\n"
    "uniform vec4 sky_weights[SKY];\n" /* direction, weight */
    "uniform float offset;\n"
    "uniform sampler2DArrayShadow sky_maps;\n"
    "out vec3 direction, sides, key_place, under;\n"
    "out vec2 open;\n" /* share of the sky that is seen from the front and from the back */
    "out float shade;\n"
    "void main() {\n"
    "    direction = normal;\n"
    "    shade = value;\n"
    "    int corner = gl_VertexID % 3;\n"
    "    sides = vec3(corner == 0, corner == 1, corner == 2);\n"
    "    gl_Position = projection * vec4(position, 1.0);\n"
    "    key_place = (key_space * vec4(position, 1.0)).xyz;\n"
    "#ifdef GROUND\n"
    "    under = (ground_space * vec4(position, 1.0)).xyz;\n"
    "#else\n"
    "    vec3 n = normalize(normal + vec3(0.0, 0.0, 1e-20));\n"
    "    vec4 sum = vec4(1e-6);\n"
    "    for (int i = 0; i < SKY; ++i) {\n"
    "        float slope = dot(n, sky_weights[i].xyz), side = slope > 0.0 ? 1.0 : -1.0;\n"
    "        vec3 at = (sky_spaces[i] * vec4(position + offset * side * n, 1.0)).xyz;\n"
    "        float weight = abs(slope) * sky_weights[i].w, seen = texture(sky_maps, vec4(at.xy, i, at.z));\n"
    "        sum += weight * (slope > 0.0 ? vec4(seen, 1.0, 0.0, 0.0) : vec4(0.0, 0.0, seen, 1.0));\n"
    "    }\n"
    "    open = sum.xz / sum.yw;\n"
    "#endif\n"
    "}\n"
    "#endif\n";

/* light is added up in squares of sRGB, which is near enough to linear: a key light from the upper left with soft
   shadows, a fill light from the right, light of the sky where it reaches; edges, bright on dark and dark on bright
   colors, where the distance to a side of the triangle, in pixels, is small. The ground shows shadows only: a soft one
   from above and the one of the key light, faded out with `shade` and towards the borders of the picture. */
static const char fragment_source[] =
    "#ifdef DEPTH\n"
    "void main() {}\n"
    "#elif defined(OUTLINE)\n"
    "uniform vec4 plain;\n"
    "out vec4 color;\n"
    "void main() { color = plain; }\n"
    "#else\n"
    "in vec3 direction, key_place, under;\n"
    "in vec2 open;\n"
    "in float shade;\n"
    "#ifdef EDGES\n"
    "in vec3 sides;\n"
    "#endif\n"
    "uniform sampler2D color_map;\n"
    "uniform sampler2DShadow key_map;\n"
    "uniform sampler2DArrayShadow sky_maps;\n"
    "uniform mat4 key_space;\n"
    "uniform vec4 plain;\n"
    "uniform float edge_width, edge_strength, highlight, occlusion, offset;\n"
    "uniform vec2 size;\n" /* pixels of the picture */
    "uniform bool colored;\n"
    "out vec4 color;\n"
    "float key_light(vec3 place, int reach, float spread) {\n"
    "    float sum = 0.0;\n"
    "    for (int i = -reach; i <= reach; ++i)\n"
    "        for (int k = -reach; k <= reach; ++k)\n"
    "            sum += texture(key_map, place + vec3(spread * vec2(i, k), 0.0));\n"
    "    return sum / float((2 * reach + 1) * (2 * reach + 1));\n"
    "}\n"
    "float light_from_above() {\n"
    "    float sum = 0.0;\n"
    "    for (int i = -5; i <= 5; ++i)\n"
    "        for (int k = -5; k <= 5; ++k)\n"
    "            sum += texture(sky_maps, vec4(under.xy + 0.016 * vec2(i, k), 24.0, under.z)) *\n"
    "                   (36.0 - float(i * i)) * (36.0 - float(k * k));\n"
    "    return sum / 81796.0;\n" /* the square of the sum of 36 - i i */
    "}\n"
    "void main() {\n"
    "    vec3 n = normalize(direction + vec3(0.0, 0.0, 1e-20));\n"
    "#ifdef GROUND\n"
    "    float missing = 0.28 * (1.0 - light_from_above()) + 0.16 * (1.0 - key_light(key_place, 3, 0.006));\n"
    /* shadows fall to the right: in narrow pictures they end at the border, and a short fade would be seen as an edge
     */
    "    vec2 inside = min(gl_FragCoord.xy, size - gl_FragCoord.xy) / vec2(0.3 * size.x, 0.12 * min(size.x, size.y));\n"
    "    missing *= smoothstep(0.0, 1.0, min(inside.x, inside.y));\n"
    "    color = vec4(0.0, 0.0, 0.0, occlusion * shade * missing);\n"
    "#else\n"
    "    n = gl_FrontFacing ? n : -n;\n"
    "    const vec3 key = normalize(vec3(-0.45, 0.65, 0.75)), fill = normalize(vec3(0.8, -0.1, 0.5));\n"
    "    const vec3 half_way = normalize(key + vec3(0.0, 0.0, 1.0));\n"
    "    vec3 place = key_place + mat3(key_space) * (2.0 * offset * n);\n"
    "    float shadow = mix(1.0, key_light(place, 1, 0.003), occlusion);\n"
    "    float sky = mix(1.0, gl_FrontFacing ? open.x : open.y, occlusion);\n"
    "    float bright_side = max(dot(n, key), 0.0);\n"
    "    float light = (0.50 + 0.10 * n.y) * sky + 0.48 * bright_side * mix(0.25, 1.0, shadow) +\n"
    "                  0.14 * max(dot(n, fill), 0.0) * sky;\n"
    "    vec3 base = colored ? texture(color_map, vec2(shade * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb : plain.rgb;\n"
    "    base *= gl_FrontFacing ? base : 0.85 * base;\n"
    "    float gloss = max(dot(n, half_way), 0.0);\n"
    "    gloss *= gloss, gloss *= gloss, gloss *= gloss, gloss *= gloss, gloss *= gloss;\n"
    "    float sheen = (0.018 * bright_side * bright_side + highlight * gloss) * shadow;\n"
    "    vec3 lit = base * light + sheen;\n"
    "    color = vec4(sqrt(min(lit, 1.0)), plain.a);\n"
    "#ifdef EDGES\n"
    "    vec3 pixels = sides / max(fwidth(sides), vec3(1e-6));\n"
    "    float nearest = min(pixels.x, min(pixels.y, pixels.z));\n"
    "    float on = 1.0 - smoothstep(0.5 * edge_width - 0.5, 0.5 * edge_width + 0.5, nearest);\n"
    "    float bright = dot(color.rgb, vec3(0.30, 0.59, 0.11));\n"
    "    color.rgb = mix(color.rgb, vec3(1.0 - smoothstep(0.25, 0.40, bright)), on * edge_strength);\n"
    "#endif\n"
    "#endif\n"
    "}\n"
    "#endif\n";

static bool compile(GLuint id, GLenum kind, const char *head, const char *source, char *text, int size)
{
    GLuint shader = glCreateShader(kind);
    GLint good = 0;
    glShaderSource(shader, 2, (const char *[]){head, source}, NULL);
    glCompileShader(shader);
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    if (!good)
        glGetShaderInfoLog(shader, size, NULL, text);
    glAttachShader(id, shader);
    glDeleteShader(shader);
    return good;
}

static pel_status make_program(program *p, const char *head, pel_error *error)
{
    char text[200] = "";
    GLint good = 0;
    p->id = glCreateProgram();
    if (compile(p->id, GL_VERTEX_SHADER, head, vertex_source, text, sizeof text) &&
        compile(p->id, GL_FRAGMENT_SHADER, head, fragment_source, text, sizeof text)) {
        glLinkProgram(p->id);
        glGetProgramiv(p->id, GL_LINK_STATUS, &good);
        if (!good)
            glGetProgramInfoLog(p->id, sizeof text, NULL, text);
    }
    if (!good) {
        text[strcspn(text, "\n")] = '\0';
        return pel_refuse(error, PEL_BAD_ARGUMENT, "set LIBGL_ALWAYS_SOFTWARE=1 to draw without the graphics card",
                          "this OpenGL refuses the shaders: %s", text);
    }
    p->projection = glGetUniformLocation(p->id, "projection");
    p->plain = glGetUniformLocation(p->id, "plain");
    p->colored = glGetUniformLocation(p->id, "colored");
    p->highlight = glGetUniformLocation(p->id, "highlight");
    p->edge_width = glGetUniformLocation(p->id, "edge_width");
    p->edge_strength = glGetUniformLocation(p->id, "edge_strength");
    p->occlusion = glGetUniformLocation(p->id, "occlusion");
    p->offset = glGetUniformLocation(p->id, "offset");
    p->size = glGetUniformLocation(p->id, "size");
    p->outline_width = glGetUniformLocation(p->id, "outline_width");
    p->key_space = glGetUniformLocation(p->id, "key_space");
    p->ground_space = glGetUniformLocation(p->id, "ground_space");
    p->sky_spaces = glGetUniformLocation(p->id, "sky_spaces");
    p->sky_weights = glGetUniformLocation(p->id, "sky_weights");
    glUseProgram(p->id);
    glUniform1i(glGetUniformLocation(p->id, "color_map"), 0);
    glUniform1i(glGetUniformLocation(p->id, "key_map"), 1);
    glUniform1i(glGetUniformLocation(p->id, "sky_maps"), 2);
    return PEL_OK;
}

static pel_status make_programs(view_gl_target *canvas, pel_error *error)
{
    static const char *const heads[PROGRAM_COUNT] = {
        "#version 330 core\n", "#version 330 core\n#define EDGES\n", "#version 330 core\n#define GROUND\n",
        "#version 330 core\n#define OUTLINE\n", "#version 330 core\n#define DEPTH\n"};
    pel_status status = PEL_OK;
    for (int i = 0; status == PEL_OK && i < PROGRAM_COUNT; ++i)
        status = make_program(&canvas->programs[i], heads[i], error);
    return status;
}

/* ---- context and buffers ---- */

static pel_status fail_context(const char *what, pel_error *error)
{
    return pel_refuse(error, PEL_BAD_ARGUMENT, "install the Debian packages libegl1, libegl-mesa0 and libgl1-mesa-dri",
                      "cannot draw: %s", what);
}

static pel_status make_context(view_gl_target *canvas, pel_error *error)
{
    static const EGLint wanted[] = {
        EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    EGLint major, minor;
    if (!epoxy_has_egl())
        return fail_context("there is no EGL on this machine", error);
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base") ||
        !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
        return fail_context("EGL cannot work without a display here", error);
    canvas->display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
    if (canvas->display == EGL_NO_DISPLAY || !eglInitialize(canvas->display, &major, &minor)) {
        canvas->display = EGL_NO_DISPLAY;
        return fail_context("EGL does not start", error);
    }
    if (!epoxy_has_egl_extension(canvas->display, "EGL_KHR_surfaceless_context") ||
        !epoxy_has_egl_extension(canvas->display, "EGL_KHR_no_config_context") || !eglBindAPI(EGL_OPENGL_API))
        return fail_context("EGL offers no OpenGL without a window", error);
    canvas->context = eglCreateContext(canvas->display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
    if (canvas->context == EGL_NO_CONTEXT ||
        !eglMakeCurrent(canvas->display, EGL_NO_SURFACE, EGL_NO_SURFACE, canvas->context))
        return fail_context("there is no OpenGL 3.3", error);
    snprintf(canvas->renderer, sizeof canvas->renderer, "%s", (const char *)glGetString(GL_RENDERER));
    return PEL_OK;
}

static pel_status make_framebuffers(view_gl_target *canvas, pel_error *error)
{
    GLint largest = 0;
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
    if (canvas->width > largest || canvas->height > largest) {
        pel_fail(error, PEL_BAD_ARGUMENT, "a picture of %d x %d pixels is too large for this OpenGL",
                 (int)canvas->width, (int)canvas->height);
        pel_fail_remedy(error, "choose at most %d pixels a side", (int)largest);
        return PEL_BAD_ARGUMENT;
    }
    static const GLenum formats[3] = {GL_RGBA8, GL_DEPTH_COMPONENT24, GL_RGBA8};
    static const GLenum places[3] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT, GL_COLOR_ATTACHMENT0};
    bool good = true;
    glGenRenderbuffers(3, canvas->renderbuffers);
    glGenFramebuffers(2, canvas->framebuffers);
    for (int i = 0; i < 3; ++i) {
        glBindRenderbuffer(GL_RENDERBUFFER, canvas->renderbuffers[i]);
        glRenderbufferStorageMultisample(GL_RENDERBUFFER, i < 2 ? SAMPLES : 0, formats[i], canvas->width,
                                         canvas->height);
        glBindFramebuffer(GL_FRAMEBUFFER, canvas->framebuffers[i / 2]);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, places[i], GL_RENDERBUFFER, canvas->renderbuffers[i]);
    }
    for (int i = 0; i < 2; ++i) {
        glBindFramebuffer(GL_FRAMEBUFFER, canvas->framebuffers[i]);
        good = good && glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
    }
    canvas->pixels = view_allocate((size_t)canvas->width * (size_t)canvas->height, 4);
    return good && canvas->pixels != NULL ? PEL_OK : pel_fail_memory(error);
}

/* a depth map, or several, that compares when it is sampled */
static GLuint make_depth_map(GLenum unit, GLenum kind, GLsizei size, GLsizei layers)
{
    GLuint map;
    glGenTextures(1, &map);
    glActiveTexture(unit);
    glBindTexture(kind, map);
    if (layers > 1)
        glTexImage3D(kind, 0, GL_DEPTH_COMPONENT24, size, size, layers, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, NULL);
    else
        glTexImage2D(kind, 0, GL_DEPTH_COMPONENT24, size, size, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, NULL);
    glTexParameteri(kind, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(kind, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(kind, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(kind, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    glTexParameteri(kind, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTexParameteri(kind, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    glActiveTexture(GL_TEXTURE0);
    return map;
}

static void make_lights(view_gl_target *canvas)
{
    canvas->key_map = make_depth_map(GL_TEXTURE1, GL_TEXTURE_2D, KEY_SIZE, 1);
    canvas->sky_maps = make_depth_map(GL_TEXTURE2, GL_TEXTURE_2D_ARRAY, SKY_SIZE, SKY + 1);
    glGenFramebuffers(1, &canvas->light_framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, canvas->light_framebuffer);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
}

static void make_layout(view_gl_target *canvas)
{
    static const GLint sizes[3] = {3, 3, 1};
    static const size_t offsets[3] = {offsetof(view_corner, position), offsetof(view_corner, normal),
                                      offsetof(view_corner, value)};
    glGenVertexArrays(1, &canvas->layout);
    glGenBuffers(1, &canvas->corners);
    glBindVertexArray(canvas->layout);
    glBindBuffer(GL_ARRAY_BUFFER, canvas->corners);
    for (GLuint i = 0; i < 3; ++i) {
        glEnableVertexAttribArray(i);
        glVertexAttribPointer(i, sizes[i], GL_FLOAT, GL_FALSE, sizeof(view_corner), (const void *)offsets[i]);
    }
    glGenTextures(1, &canvas->color_map);
    glBindTexture(GL_TEXTURE_2D, canvas->color_map);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    view_gl_target_set_color_map(canvas, PEL_COLORS_VIRIDIS);
    glEnable(GL_DEPTH_TEST);
    glFrontFace(GL_CCW);
}

pel_status view_gl_target_create(int32_t width, int32_t height, view_gl_target **canvas, pel_error *error)
{
    *canvas = NULL;
    view_gl_target *made = view_allocate(1, sizeof *made);
    if (made == NULL)
        return pel_fail_memory(error);
    made->width = width;
    made->height = height;
    pel_status status = make_context(made, error);
    if (status == PEL_OK)
        status = make_framebuffers(made, error);
    if (status == PEL_OK)
        status = make_programs(made, error);
    if (status != PEL_OK) {
        view_gl_target_destroy(made);
        return status;
    }
    make_layout(made);
    make_lights(made);
    *canvas = made;
    return PEL_OK;
}

void view_gl_target_destroy(view_gl_target *canvas)
{
    if (canvas == NULL)
        return;
    /* the context takes its buffers and programs with it */
    if (canvas->display != EGL_NO_DISPLAY) {
        eglMakeCurrent(canvas->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (canvas->context != EGL_NO_CONTEXT)
            eglDestroyContext(canvas->display, canvas->context);
        eglTerminate(canvas->display);
        eglReleaseThread();
    }
    free(canvas->pixels);
    free(canvas);
}

const char *view_gl_target_renderer(const view_gl_target *canvas)
{
    return canvas->renderer;
}

static void set_colors(view_gl_target *canvas, uint8_t table[COLOR_STEPS][4])
{
    glBindTexture(GL_TEXTURE_2D, canvas->color_map);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, COLOR_STEPS, 1, 0, GL_RGBA, GL_UNSIGNED_BYTE, table);
}

void view_gl_target_set_color_map(view_gl_target *canvas, pel_color_map map)
{
    uint8_t table[COLOR_STEPS][4];
    for (int i = 0; i < COLOR_STEPS; ++i) {
        pel_color_map_sample(map, i / (COLOR_STEPS - 1.0), table[i]);
        table[i][3] = 255;
    }
    set_colors(canvas, table);
}

void view_gl_target_set_palette(view_gl_target *canvas, const uint8_t (*colors)[3], int32_t count)
{
    uint8_t table[COLOR_STEPS][4];
    for (int i = 0; i < COLOR_STEPS; ++i) {
        memcpy(table[i], colors[i * count / COLOR_STEPS], sizeof *colors);
        table[i][3] = 255;
    }
    set_colors(canvas, table);
}

/* ---- drawing ---- */

void view_gl_target_watch(view_gl_target *canvas, bool (*wanted)(void *user), void *user)
{
    canvas->wanted = wanted;
    canvas->user = user;
}

/* Draws triangles in portions. OpenGL only queues draw calls: between two portions it has to finish before `wanted` is
   called. */
static void draw_corners(view_gl_target *canvas, size_t first, size_t count)
{
    for (size_t end = first + count; first < end && !canvas->is_stopped; first += PORTION) {
        size_t size = end - first < PORTION ? end - first : PORTION;
        glDrawArrays(GL_TRIANGLES, (GLint)first, (GLsizei)size);
        if (count <= PORTION || canvas->wanted == NULL)
            continue;
        glFinish();
        canvas->is_stopped = !canvas->wanted(canvas->user);
    }
}

void view_gl_target_begin(view_gl_target *canvas, const view_camera *camera, view_color background)
{
    float part[4];
    for (int i = 0; i < 4; ++i)
        part[i] = (float)background.rgba[i] / 255;
    glBindFramebuffer(GL_FRAMEBUFFER, canvas->framebuffers[0]);
    glDisable(GL_BLEND);
    /* pixels that are read have premultiplied alpha */
    glClearColor(part[0] * part[3], part[1] * part[3], part[2] * part[3], part[3]);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    canvas->background = background;
    canvas->low[0] = canvas->width;
    canvas->low[1] = canvas->height;
    canvas->high[0] = canvas->high[1] = 0;
    view_camera_project(camera, canvas->projection);
    for (int i = 0; i < 3; ++i)
        canvas->up[i] = (float)camera->axes[i][camera->up];
}

/* ---- light ---- */

/* parallel light from a direction (length 1) onto a ball */
static light_space look_from(const float direction[3], const double center[3], float radius)
{
    const float *d = direction;
    /* two unit vectors across (Duff et al. 2017) */
    float sign = d[2] < 0 ? -1 : 1, a = -1 / (sign + d[2]), b = d[0] * d[1] * a;
    float axes[3][3] = {{1 + sign * d[0] * d[0] * a, sign * b, -sign * d[0]}, {b, sign + d[1] * d[1] * a, -d[1]}};
    light_space space = {{0}};
    for (int k = 0; k < 3; ++k)
        axes[2][k] = -d[k];
    for (int row = 0; row < 3; ++row) {
        for (int k = 0; k < 3; ++k) {
            space.matrix[4 * k + row] = axes[row][k] / radius;
            space.matrix[12 + row] -= axes[row][k] / radius * (float)center[k];
        }
    }
    space.matrix[15] = 1;
    return space;
}

/* the same space with x, y and depth in 0 .. 1, as maps are sampled */
static light_space sampled(light_space space)
{
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 3; ++row)
            space.matrix[4 * column + row] = 0.5f * space.matrix[4 * column + row] + (column == 3 ? 0.5f : 0);
    }
    return space;
}

static void draw_depth(view_gl_target *canvas, const light_space *space, int32_t size, size_t count)
{
    const program *p = &canvas->programs[PROGRAM_DEPTH];
    glViewport(0, 0, size, size);
    glClear(GL_DEPTH_BUFFER_BIT);
    glUseProgram(p->id);
    glUniformMatrix4fv(p->projection, 1, GL_FALSE, space->matrix);
    draw_corners(canvas, 0, count);
}

/* weights: directions of the sky along the axes of the camera and how bright they are */
static void place_sky(const float up[3], float weights[SKY][4])
{
    for (int i = 0; i < SKY; ++i) {
        double z = 1 - (2 * i + 1) / (double)SKY, around = 2.399963229728653 * i, across = sqrt(1 - z * z);
        const float at[3] = {(float)(across * cos(around)), (float)(across * sin(around)), (float)z};
        float height = 0;
        for (int k = 0; k < 3; ++k) {
            weights[i][k] = at[k];
            height += at[k] * up[k];
        }
        weights[i][3] = 0.75f + 0.25f * height;
    }
}

void view_gl_target_load(view_gl_target *canvas, const view_triangle_list *soup, size_t occluder_count,
                         const double center[3], double reach)
{
    static const float key[3] = {-0.4129483f, 0.5964809f, 0.6882472f};
    float weights[SKY][4], radius = (float)reach;
    light_space spaces[SKY + 1], key_space;
    glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(soup->count * sizeof *soup->corners), soup->corners, GL_STREAM_DRAW);
    glBindFramebuffer(GL_FRAMEBUFFER, canvas->light_framebuffer);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1.5f, 4);
    place_sky(canvas->up, weights);
    for (int i = 0; i <= SKY; ++i) {
        spaces[i] = look_from(i < SKY ? weights[i] : canvas->up, center, radius);
        glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, canvas->sky_maps, 0, i);
        draw_depth(canvas, &spaces[i], SKY_SIZE, occluder_count);
        spaces[i] = sampled(spaces[i]);
    }
    key_space = look_from(key, center, radius);
    glFramebufferTexture(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, canvas->key_map, 0);
    draw_depth(canvas, &key_space, KEY_SIZE, occluder_count);
    key_space = sampled(key_space);
    glDisable(GL_POLYGON_OFFSET_FILL);
    glBindFramebuffer(GL_FRAMEBUFFER, canvas->framebuffers[0]);
    glViewport(0, 0, canvas->width, canvas->height);
    for (int i = 0; i < PROGRAM_DEPTH; ++i) {
        const program *p = &canvas->programs[i];
        glUseProgram(p->id);
        glUniformMatrix4fv(p->projection, 1, GL_FALSE, canvas->projection);
        glUniformMatrix4fv(p->key_space, 1, GL_FALSE, key_space.matrix);
        glUniformMatrix4fv(p->ground_space, 1, GL_FALSE, spaces[SKY].matrix);
        glUniformMatrix4fv(p->sky_spaces, SKY, GL_FALSE, spaces[0].matrix);
        glUniform4fv(p->sky_weights, SKY, weights[0]);
        /* about a pixel of a map of the sky */
        glUniform1f(p->offset, 2 * radius / SKY_SIZE);
        glUniform2f(p->size, (float)canvas->width, (float)canvas->height);
    }
}

/* ---- triangles ---- */

/* grows the part that was drawn on by four pixels around each corner, which is more than an outline takes */
static void note_part(view_gl_target *canvas, const view_corner *corners, size_t count)
{
    const float *m = canvas->projection, size[2] = {(float)canvas->width, (float)canvas->height};
    float low[2] = {size[0], size[1]}, high[2] = {0, 0};
    bool before = true;
    for (size_t i = 0; i < count; ++i) {
        const float *p = corners[i].position;
        float w = m[3] * p[0] + m[7] * p[1] + m[11] * p[2] + m[15];
        before = before && w > 0;
        for (int k = 0; k < 2; ++k) {
            float at = (m[k] * p[0] + m[4 + k] * p[1] + m[8 + k] * p[2] + m[12 + k]) / w;
            at = (0.5f + 0.5f * at) * size[k];
            low[k] = at < low[k] ? at : low[k];
            high[k] = at > high[k] ? at : high[k];
        }
    }
    for (int k = 0; k < 2; ++k) {
        /* points beside or behind the camera have no bounded projection */
        int32_t first = before && low[k] > 4 ? (int32_t)low[k] - 4 : 0;
        int32_t end = before && high[k] < size[k] - 5 ? (int32_t)high[k] + 5 : (int32_t)size[k];
        canvas->low[k] = first < canvas->low[k] ? first : canvas->low[k];
        canvas->high[k] = end > canvas->high[k] ? end : canvas->high[k];
    }
}

void view_gl_target_draw(view_gl_target *canvas, const view_triangle_list *soup, size_t first, size_t count,
                         const view_look *look)
{
    if (count == 0)
        return;
    note_part(canvas, soup->corners + first, count);
    const program *p = &canvas->programs[look->ground              ? PROGRAM_GROUND
                                         : look->outline_width > 0 ? PROGRAM_OUTLINE
                                         : look->edge_width > 0    ? PROGRAM_EDGES
                                                                   : PROGRAM_PLAIN];
    float plain[4];
    for (int i = 0; i < 4; ++i)
        plain[i] = (float)look->plain.rgba[i] / 255;
    glUseProgram(p->id);
    glUniform4fv(p->plain, 1, plain);
    glUniform1i(p->colored, look->colored);
    glUniform1f(p->highlight, (float)look->highlight);
    glUniform1f(p->edge_width, (float)look->edge_width);
    glUniform1f(p->edge_strength, (float)look->edge_strength);
    glUniform1f(p->occlusion, (float)look->occlusion);
    glUniform1f(p->outline_width, (float)look->outline_width);
    glCullFace(look->outline_width > 0 ? GL_FRONT : GL_BACK);
    if (look->ground || look->plain.rgba[3] < 255) {
        glEnable(GL_BLEND);
        glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
        glEnable(GL_CULL_FACE);
    } else {
        glDisable(GL_BLEND);
        if (look->outline_width > 0)
            glEnable(GL_CULL_FACE);
        else
            glDisable(GL_CULL_FACE);
    }
    /* what is below the ground, such as the foot of a table, is seen through it */
    glDepthMask(look->ground ? GL_FALSE : GL_TRUE);
    draw_corners(canvas, first, count);
    glDepthMask(GL_TRUE);
}

/* a row of pixels with its alpha divided out again */
static void copy_row(const uint8_t *from, uint8_t *to, int32_t width)
{
    for (int32_t i = 0; i < width; ++i, from += 4, to += 4) {
        uint32_t alpha = from[3];
        if (alpha == 255 || alpha == 0) {
            memcpy(to, from, 4);
            continue;
        }
        for (int k = 0; k < 3; ++k) {
            uint32_t part = (from[k] * 255u + alpha / 2) / alpha;
            to[k] = (uint8_t)(part > 255 ? 255 : part);
        }
        to[3] = from[3];
    }
}

/* the picture around the part that was drawn on */
static void fill_around(const view_gl_target *canvas, view_image *image, int32_t x, int32_t y, view_color color)
{
    int32_t width = canvas->width, height = canvas->height, left = canvas->low[0], right = canvas->high[0];
    int32_t top = height - canvas->high[1], bottom = height - canvas->low[1];
    if (left >= right || top >= bottom) {
        view_image_fill(image, x, y, width, height, color);
        return;
    }
    view_image_fill(image, x, y, width, top, color);
    view_image_fill(image, x, y + bottom, width, height - bottom, color);
    view_image_fill(image, x, y + top, left, bottom - top, color);
    view_image_fill(image, x + right, y + top, width - right, bottom - top, color);
}

pel_status view_gl_target_read(view_gl_target *canvas, view_image *image, int32_t x, int32_t y, pel_error *error)
{
    if (canvas->is_stopped)
        return pel_fail(error, PEL_STOPPED, "stopped while drawing");
    /* software takes as long for a pixel of the background as for any other: leave those out */
    const int32_t *low = canvas->low, *high = canvas->high;
    const view_color nothing = {{0, 0, 0, 0}};
    fill_around(canvas, image, x, y, canvas->background.rgba[3] > 0 ? canvas->background : nothing);
    if (low[0] >= high[0] || low[1] >= high[1])
        return PEL_OK;
    int32_t width = high[0] - low[0], height = high[1] - low[1];
    glBindFramebuffer(GL_READ_FRAMEBUFFER, canvas->framebuffers[0]);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, canvas->framebuffers[1]);
    glBlitFramebuffer(low[0], low[1], high[0], high[1], low[0], low[1], high[0], high[1], GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, canvas->framebuffers[1]);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(low[0], low[1], width, height, GL_RGBA, GL_UNSIGNED_BYTE, canvas->pixels);
    if (glGetError() != GL_NO_ERROR)
        return pel_fail_memory(error);
    int32_t top = y + canvas->height - high[1], left = x + low[0];
    for (int32_t row = 0; row < height; ++row) {
        const uint8_t *from = canvas->pixels + 4 * (size_t)(height - 1 - row) * (size_t)width;
        copy_row(from, image->pixels + 4 * ((size_t)(top + row) * (size_t)image->width + (size_t)left), width);
    }
    return PEL_OK;
}
