#include "misuse.h"
#include "source_dir.h"

#include <pellicle/server.h>

static void test_server(void **unused)
{
    (void)unused;
    static const char text[] = "version: 1\nbodies: [{ mesh: { shape: geodesic-sphere } }]\nduration: 1\n";
    pel_scene *scene;
    assert_int_equal(pel_scene_parse("ball.yaml", text, strlen(text), NULL, 0, NULL, &scene, NULL), PEL_OK);
    pel_server_def def = pel_server_def_default(), wrong;
    def.scene = scene;
    def.page = PEL_SOURCE_DIR "/README.md";
    REFUSED("def", pel_serve(NULL, &error));
    wrong = def, wrong.cookie = 0;
    REFUSED("default", pel_serve(&wrong, &error));
    wrong = def, wrong.scene = NULL;
    REFUSED("scene", pel_serve(&wrong, &error));
    wrong = def, wrong.page = NULL;
    REFUSED("page", pel_serve(&wrong, &error));
    wrong = def, wrong.port = 65536;
    REFUSED("port", pel_serve(&wrong, &error));
    wrong = def, wrong.thread_count = -1;
    REFUSED("threads", pel_serve(&wrong, &error));
    wrong = def, wrong.page = "no-such-page.html";
    FAILS(pel_serve(&wrong, &error));
    wrong = def, wrong.host = "203.0.113.1";
    FAILS(pel_serve(&wrong, &error));
    REFUSED("path", pel_page_write(NULL, def.page, scene, false, &error));
    REFUSED("template", pel_page_write("page.html", NULL, scene, false, &error));
    REFUSED("scene", pel_page_write("page.html", def.page, NULL, false, &error));
    FAILS(pel_page_write("page.html", def.page, scene, false, &error));
    pel_scene_destroy(scene);
    assert_int_equal(misuse_failures, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_server)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
