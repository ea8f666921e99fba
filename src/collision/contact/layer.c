#include "contact/layer.h"

#include <math.h>

/* 1/2 m v^2 = 1/2 k (h / 2)^2 */
#define ABSORB 4.0
/* of mass / dt^2 */
#define STIFF 1000.0

/* of the thickness: update pairs nearer to their layer in every substep */
#define NEAR_SHARE 0.1
/* substeps at most */
enum { LONGEST_WAIT = 8 };

double pel_contact_layer_compliance(const pel_contact_layer *layer, double mass, double speed, double dt)
{
    double rate = speed / layer->thickness, needed = ABSORB * rate * rate;
    double hardness = layer->hardness > 0 ? layer->hardness : STIFF / (dt * dt);
    return 1 / (mass * (hardness > needed ? hardness : needed));
}

int32_t pel_contact_layer_wait(double room, double before, double thickness)
{
    if (!(room > NEAR_SHARE * thickness))
        return 0;
    double count = room / (4 * fabs(before - room));
    return count < LONGEST_WAIT ? (int32_t)count : LONGEST_WAIT;
}
