#include <pellicle/scene.h>

#include <cstdio>

/* a scene that does not exist is refused with its name */
int main()
{
    pel_scene *scene = nullptr;
    pel_error error;
    char text[800];
    if (pel_scene_load("absent.yaml", nullptr, 0, nullptr, &scene, &error) == PEL_OK)
        return 1;
    std::printf("%s\n", pel_error_text(&error, text, sizeof text));
    return 0;
}
