#include "contact/layer.h"

#include <math.h>

/* 1/2 m v^2 = 1/2 k (h / 2)^2 */
#define ABSORB 4.0
/* of mass / dt^2 */
#define STIFF 1000.0

double pel_contact_layer_compliance(const pel_contact_layer *layer, double mass, double speed, double dt)
{
    double rate = speed / layer->thickness, needed = ABSORB * rate * rate;
    double hardness = layer->hardness > 0 ? layer->hardness : STIFF / (dt * dt);
    return 1 / (mass * (hardness > needed ? hardness : needed));
}
