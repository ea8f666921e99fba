#include "check.h"
#include "failing_malloc.h"
#include "random.h"

#include "io/vtk_blocks.h"

#include <stdlib.h>

enum { BLOCK = 1 << 16, HEAD = 3 };

static unsigned char *sample_bytes(size_t size)
{
    random_state random = {size};
    unsigned char *bytes = malloc(size + 1);
    assert_non_null(bytes);
    for (size_t i = 0; i < size; i++)
        bytes[i] = i % 3 == 0 ? (unsigned char)random_bits(&random) : (unsigned char)(i / 100);
    return bytes;
}

static unsigned char *pack(const unsigned char *bytes, size_t size, size_t *packed_size)
{
    unsigned char *packed = malloc(pel_vtk_blocks_bound(size));
    assert_non_null(packed);
    assert_int_equal(pel_vtk_blocks_pack(bytes, size, packed, packed_size, NULL), PEL_OK);
    assert_true(*packed_size <= pel_vtk_blocks_bound(size));
    return packed;
}

static void set_word(unsigned char *packed, size_t index, uint64_t value)
{
    memcpy(packed + 8 * index, &value, sizeof value);
}

static uint64_t word_at(const unsigned char *packed, size_t index)
{
    return pel_vtk_blocks_word(packed + 8 * index, 8);
}

static void test_round_trip(void **unused)
{
    (void)unused;
    const size_t sizes[] = {0, 1, BLOCK - 1, BLOCK, BLOCK + 1, 3 * BLOCK, 200000};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        size_t size = sizes[i], packed_size;
        unsigned char *bytes = sample_bytes(size), *packed = pack(bytes, size, &packed_size), *back = malloc(size + 1);
        assert_int_equal(pel_vtk_blocks_check(packed, packed_size, 8, size), packed_size);
        /* bytes after it do not belong to it */
        assert_int_equal(pel_vtk_blocks_check(packed, packed_size + 5, 8, size), packed_size);
        assert_int_equal(pel_vtk_blocks_unpack(packed, 8, back, size, NULL), PEL_OK);
        assert_memory_equal(back, bytes, size);
        free(back);
        free(packed);
        free(bytes);
    }
}

/* words of 4 bytes, as other writers use them */
static void test_short_words(void **unused)
{
    (void)unused;
    size_t size = BLOCK + 7, packed_size, words = HEAD + 2;
    unsigned char *bytes = sample_bytes(size), *packed = pack(bytes, size, &packed_size), *back = malloc(size);
    unsigned char *narrow = malloc(packed_size);
    for (size_t i = 0; i < words; i++) {
        uint32_t word = (uint32_t)word_at(packed, i);
        memcpy(narrow + 4 * i, &word, sizeof word);
    }
    memcpy(narrow + 4 * words, packed + 8 * words, packed_size - 8 * words);
    assert_int_equal(pel_vtk_blocks_check(narrow, packed_size - 4 * words, 4, size), packed_size - 4 * words);
    assert_int_equal(pel_vtk_blocks_unpack(narrow, 4, back, size, NULL), PEL_OK);
    assert_memory_equal(back, bytes, size);
    free(narrow);
    free(back);
    free(packed);
    free(bytes);
}

static void test_heads_that_lie(void **unused)
{
    (void)unused;
    size_t size = BLOCK + 100, packed_size;
    unsigned char *bytes = sample_bytes(size), *packed = pack(bytes, size, &packed_size);
    for (size_t available = 0; available < packed_size; available += available < 64 ? 1 : 777)
        assert_int_equal(pel_vtk_blocks_check(packed, available, 8, size), 0);
    assert_int_equal(pel_vtk_blocks_check(packed, packed_size, 8, size + 1), 0);
    assert_int_equal(pel_vtk_blocks_check(packed, packed_size, 8, 0), 0);
    const struct {
        size_t index;
        uint64_t value;
    } lies[] = {{0, 1},           {0, 3}, {0, UINT64_MAX}, {1, 0},          {1, BLOCK + 1},  {1, UINT64_MAX},
                {2, BLOCK + 100}, {2, 0}, {2, 101},        {3, UINT64_MAX}, {4, packed_size}};
    for (size_t i = 0; i < sizeof lies / sizeof *lies; i++) {
        uint64_t truth = word_at(packed, lies[i].index);
        set_word(packed, lies[i].index, lies[i].value);
        assert_int_equal(pel_vtk_blocks_check(packed, packed_size, 8, size), 0);
        set_word(packed, lies[i].index, truth);
    }
    /* a last block that is longer than a whole one */
    set_word(packed, 0, 1);
    set_word(packed, 2, size);
    assert_int_equal(pel_vtk_blocks_check(packed, packed_size, 8, size), 0);
    /* a few bytes cannot hold a gigabyte, even if the header says so: nothing must be allocated for it */
    uint64_t bomb[HEAD + 1 + 4] = {1, 1 << 30, 0, 32};
    assert_int_equal(pel_vtk_blocks_check((unsigned char *)bomb, sizeof bomb, 8, 1 << 30), 0);
    free(packed);
    free(bytes);
}

/* the packed bytes hold less or more than the head says, or are damaged */
static void test_damaged_blocks(void **unused)
{
    (void)unused;
    unsigned char *bytes = sample_bytes(1000), back[2000];
    size_t packed_size;
    unsigned char *packed = pack(bytes, 1000, &packed_size);
    pel_error error;
    const size_t wrong[] = {999, 1001, 2000};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        set_word(packed, 2, wrong[i]);
        assert_int_equal(pel_vtk_blocks_check(packed, packed_size, 8, wrong[i]), packed_size);
        assert_int_equal(pel_vtk_blocks_unpack(packed, 8, back, wrong[i], &error), PEL_BAD_FORMAT);
    }
    set_word(packed, 2, 1000);
    assert_int_equal(pel_vtk_blocks_unpack(packed, 8, back, 1000, &error), PEL_OK);
    packed[packed_size - 1] ^= 1; /* the checksum */
    assert_int_equal(pel_vtk_blocks_unpack(packed, 8, back, 1000, &error), PEL_BAD_FORMAT);
    free(packed);
    free(bytes);
}

static pel_status there_and_back(const void *data, pel_error *error)
{
    static unsigned char packed[4000], back[1000];
    size_t size;
    pel_status status = pel_vtk_blocks_pack(data, sizeof back, packed, &size, error);
    return status == PEL_OK ? pel_vtk_blocks_unpack(packed, 8, back, sizeof back, error) : status;
}

static void test_allocation_failures(void **unused)
{
    (void)unused;
    unsigned char *bytes = sample_bytes(1000);
    assert_true(for_every_allocation_failure(there_and_back, bytes) >= 2);
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),          cmocka_unit_test(test_short_words),
        cmocka_unit_test(test_heads_that_lie),      cmocka_unit_test(test_damaged_blocks),
        cmocka_unit_test(test_allocation_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
