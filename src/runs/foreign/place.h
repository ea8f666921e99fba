/* Places of prims and nodes in a scene: affine maps x -> linear x + shift. */
#ifndef PEL_FOREIGN_PLACE_H
#define PEL_FOREIGN_PLACE_H

#include <stdbool.h>

typedef struct pel_place {
    double linear[3][3];
    double shift[3];
} pel_place;

pel_place pel_place_identity(void);
/* x -> outer(inner(x)) */
pel_place pel_place_product(const pel_place *outer, const pel_place *inner);
void pel_place_point(const pel_place *place, const double point[3], double placed[3]);
bool pel_place_mirrors(const pel_place *place);
/* x -> R (s x) + t with the rotation of the quaternion x, y, z, w of any length; false if it has none */
bool pel_place_by_parts(const double t[3], const double q[4], const double s[3], pel_place *place);
/* false if the map has no inverse */
bool pel_place_inverse(const pel_place *place, pel_place *inverse);

#endif
