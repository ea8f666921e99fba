#ifndef PEL_MACOS_DIRENT_H
#define PEL_MACOS_DIRENT_H
#include <sys/types.h>
typedef struct __dirstream DIR;
struct dirent {
    ino_t d_ino;
    uint64_t d_seekoff;
    uint16_t d_reclen, d_namlen;
    uint8_t d_type;
    char d_name[1024];
};
DIR *opendir(const char *path);
DIR *fdopendir(int descriptor);
struct dirent *readdir(DIR *stream);
void rewinddir(DIR *stream);
int closedir(DIR *stream);
int dirfd(DIR *stream);
#endif
