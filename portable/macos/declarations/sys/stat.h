#ifndef PEL_MACOS_SYS_STAT_H
#define PEL_MACOS_SYS_STAT_H
#include <sys/types.h>
#define S_IFMT 0170000
#define S_ISDIR(mode) (((mode)&S_IFMT) == 0040000)
#define S_ISCHR(mode) (((mode)&S_IFMT) == 0020000)
#define S_ISREG(mode) (((mode)&S_IFMT) == 0100000)
#define S_ISFIFO(mode) (((mode)&S_IFMT) == 0010000)
#define S_ISLNK(mode) (((mode)&S_IFMT) == 0120000)
#define S_ISSOCK(mode) (((mode)&S_IFMT) == 0140000)
struct stat {
    dev_t st_dev;
    mode_t st_mode;
    nlink_t st_nlink;
    ino_t st_ino;
    uid_t st_uid;
    gid_t st_gid;
    dev_t st_rdev;
    struct timespec st_atimespec, st_mtimespec, st_ctimespec, st_birthtimespec;
    off_t st_size;
    blkcnt_t st_blocks;
    blksize_t st_blksize;
    uint32_t st_flags, st_gen;
};
#define st_mtime st_mtimespec.tv_sec
int stat(const char *path, struct stat *information);
int lstat(const char *path, struct stat *information);
int fstat(int descriptor, struct stat *information);
int chmod(const char *path, mode_t mode);
int fchmod(int descriptor, mode_t mode);
int mkdir(const char *path, mode_t mode);
int mkfifo(const char *path, mode_t mode);
mode_t umask(mode_t mask);
#endif
