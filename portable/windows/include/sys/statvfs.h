/* Windows: bytes of a disk that are free for this user. */
#ifndef PEL_PORTABLE_WINDOWS_STATVFS_H
#define PEL_PORTABLE_WINDOWS_STATVFS_H
struct statvfs {
    unsigned long long f_frsize, f_bavail;
};
/* path: a folder; one that is not there fails */
int pel_windows_statvfs(const char *path, struct statvfs *disk);
#define statvfs(path, disk) pel_windows_statvfs(path, disk)
#endif
