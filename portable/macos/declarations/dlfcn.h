#ifndef PEL_MACOS_DLFCN_H
#define PEL_MACOS_DLFCN_H
#define RTLD_LAZY 1
#define RTLD_NOW 2
typedef struct dl_info {
    const char *dli_fname;
    void *dli_fbase;
    const char *dli_sname;
    void *dli_saddr;
} Dl_info;
int dladdr(const void *address, Dl_info *information);
void *dlopen(const char *path, int mode);
void *dlsym(void *library, const char *name);
int dlclose(void *library);
char *dlerror(void);
#endif
