/* The words of the rows of the table of members: for files that write rows, and no others. */
#ifndef PEL_DEF_ROW_WORDS_H
#define PEL_DEF_ROW_WORDS_H

#include "def/row.h"

#include <math.h>

/* ---- forms ---- */

#define NUMBER .forms = PEL_FORM_NUMBER
#define INTEGER .forms = PEL_FORM_INTEGER
#define BOOLEAN .forms = PEL_FORM_BOOLEAN
#define BOOLEAN_OR(...) .forms = PEL_FORM_BOOLEAN | PEL_FORM_WORD, WORDS(__VA_ARGS__)
#define TEXT .forms = PEL_FORM_TEXT
#define VECTOR .forms = PEL_FORM_VECTOR
#define LIST .forms = PEL_FORM_LIST
#define MAP .forms = PEL_FORM_MAP
#define WORD_LIST(...)                                                                                                 \
    (const char *const[])                                                                                              \
    {                                                                                                                  \
        __VA_ARGS__, NULL                                                                                              \
    }
#define WORDS(...) .words = WORD_LIST(__VA_ARGS__)
#define WORD(...) .forms = PEL_FORM_WORD, WORDS(__VA_ARGS__)
#define INTEGER_OR(...) .forms = PEL_FORM_INTEGER | PEL_FORM_WORD, WORDS(__VA_ARGS__)
#define WORD_OR_MAP(...) .forms = PEL_FORM_WORD | PEL_FORM_MAP, WORDS(__VA_ARGS__)
#define NUMBER_OR(...) .forms = PEL_FORM_NUMBER | PEL_FORM_WORD, WORDS(__VA_ARGS__)
/* a number, over the body or over time */
#define QUANTITY .forms = PEL_FORM_NUMBER | PEL_FORM_MAP, .like = "<quantity>"
/* a number, over the body */
#define FIELD .forms = PEL_FORM_NUMBER | PEL_FORM_MAP, .like = "<field>"
#define REGION .forms = PEL_FORM_WORD | PEL_FORM_MAP, WORDS("all", "boundary"), .like = "<region>"
#define NAME TEXT, .unit = "letters", BETWEEN(1, PEL_NAME_SIZE - 1)

#define POSITIVE .range = {true, true, 0, (double)HUGE_VAL}
#define AT_LEAST(least) .range = {true, false, least, (double)HUGE_VAL}
#define BETWEEN(least, most) .range = {true, false, least, most}
#define COUNT_FROM(least) BETWEEN(least, INT32_MAX)

#define REQUIRED .required = true
#define ALTERNATIVE .alternative = true

/* ---- members ---- */

/* the type of the member says how it is stored */
#define STORE_OF(member)                                                                                               \
    _Generic((member),                                                                                                 \
        double: PEL_STORE_DOUBLE,                                                                                      \
        double *: PEL_STORE_DOUBLE,                                                                                    \
        double(*)[2]: PEL_STORE_DOUBLE,                                                                                \
        double(*)[3]: PEL_STORE_DOUBLE,                                                                                \
        int: PEL_STORE_INT,                                                                                            \
        unsigned: PEL_STORE_INT,                                                                                       \
        int64_t: PEL_STORE_INT64,                                                                                      \
        bool: PEL_STORE_BOOL,                                                                                          \
        bool *: PEL_STORE_BOOL,                                                                                        \
        pel_quantity: PEL_STORE_QUANTITY,                                                                              \
        const pel_key *: PEL_STORE_KEYS,                                                                               \
        const pel_pose_key *: PEL_STORE_LIST,                                                                          \
        const int32_t *: PEL_STORE_LIST,                                                                               \
        const double *: PEL_STORE_FIELD,                                                                               \
        const pel_sequence *: PEL_STORE_SEQUENCE,                                                                      \
        const pel_mesh *: PEL_STORE_MESH,                                                                              \
        const char *: PEL_STORE_TEXT)
#define MEMBER(type, member) (((type *)NULL)->member)
#define PLACE(KIND, type, member, PART) .def = PEL_DEF_##KIND, .part = PEL_PART_##PART, .offset = offsetof(type, member)
/* a member of a def, in a part of the fingerprint */
#define OF(KIND, type, member, PART)                                                                                   \
    PLACE(KIND, type, member, PART), .store = STORE_OF(MEMBER(type, member)), .size = sizeof MEMBER(type, member)
/* a list and its count */
#define LIST_OF(KIND, type, member, count, PART)                                                                       \
    PLACE(KIND, type, member, PART), .store = STORE_OF(MEMBER(type, member)), .size = sizeof *MEMBER(type, member),    \
                                     .count_offset = offsetof(type, count)
/* a def, and a list of defs and its count */
#define DEF_OF(KIND, type, member, ELEMENT, PART)                                                                      \
    PLACE(KIND, type, member, PART), .store = PEL_STORE_DEF, .element = PEL_DEF_##ELEMENT
#define DEFS_OF(KIND, type, member, count, ELEMENT, PART)                                                              \
    PLACE(KIND, type, member, PART), .store = PEL_STORE_DEFS, .element = PEL_DEF_##ELEMENT,                            \
                                     .size = sizeof *MEMBER(type, member), .count_offset = offsetof(type, count)

/* one default for scenes and for new defs: a number, or true */
#define DEFAULT(value) .preset = #value, .initial = value
#define AUTO(value) .may_be_auto = true, .automatic = value
#define FACTOR(value) .factor = value
/* no parameter of a simulation that runs */
#define FIXED .is_fixed = true
#define DIRECT .is_direct = true
#define IMPLYING .is_implying = true
#define REFUSED(why, instead) .refusal = why, .remedy = instead

#endif
