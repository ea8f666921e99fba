#include "base/memory.h"
#include "io/json.h"
#include "live/player.h"
#include "wasm/calls.h"
#include "wasm/error.h"

#include <string.h>

struct pel_wasm_live {
    pel_scene *scene;
    pel_server_def def;
    pel_mailbox box;
    pel_mail_reader reader;
    pel_player *player;
    pel_error error;
    pel_status status;
    pel_json json;
    unsigned char *message; /* (room) the last one taken */
    size_t room;
    int kind;
    pel_wasm_text out;
};

pel_wasm_live *pel_wasm_live_create(const char *path, const char *text, int32_t size, const char *const *overrides,
                                    int32_t override_count)
{
    pel_wasm_live *live = pel_allocate(1, sizeof *live);
    if (live == NULL)
        return NULL;
    pel_mailbox_create(&live->box);
    live->status =
        pel_scene_parse(path, text, (size_t)size, overrides, override_count, NULL, &live->scene, &live->error);
    live->def = (pel_server_def){.scene = live->scene, .thread_count = 1};
    if (live->status == PEL_OK) {
        live->status = pel_player_create(&live->def, &live->box, &live->player, &live->error);
        if (live->status != PEL_OK)
            pel_scene_locate(live->scene, &live->error);
    }
    pel_mailbox_welcome(&live->box, &live->reader);
    return live;
}

void pel_wasm_live_destroy(pel_wasm_live *live)
{
    if (live == NULL)
        return;
    pel_player_destroy(live->player);
    pel_mailbox_destroy(&live->box);
    pel_scene_destroy(live->scene);
    pel_json_free(&live->json);
    pel_free(live->message);
    pel_free(live);
}

int32_t pel_wasm_live_status(const pel_wasm_live *live)
{
    return (int32_t)live->status;
}

const pel_wasm_text *pel_wasm_live_error(pel_wasm_live *live)
{
    pel_json_free(&live->json);
    live->json = (pel_json){0};
    pel_wasm_put_error(&live->json, &live->error);
    live->out = (pel_wasm_text){live->json.failed ? NULL : live->json.text, (int32_t)live->json.length};
    return &live->out;
}

void pel_wasm_live_line(pel_wasm_live *live, const char *line)
{
    if (strcmp(line, "received") == 0)
        pel_mailbox_received(&live->reader);
    else
        pel_mailbox_line(&live->box, pel_copy_string(line), pel_player_interrupts(line));
}

double pel_wasm_live_turn(pel_wasm_live *live)
{
    (void)pel_player_turn(live->player, 0);
    return pel_player_rest(live->player);
}

const pel_wasm_text *pel_wasm_live_take(pel_wasm_live *live)
{
    size_t size = 0;
    live->kind = pel_mailbox_take(&live->box, &live->reader, 0, &live->message, &live->room, &size);
    live->out = (pel_wasm_text){(const char *)live->message, (int32_t)size};
    return &live->out;
}

int32_t pel_wasm_live_is_binary(const pel_wasm_live *live)
{
    return live->kind == PEL_POST_FRAME || live->kind == PEL_POST_SURFACE;
}
