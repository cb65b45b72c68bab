; The installer for one user, without the rights of an administrator. /S installs without questions, /D=FOLDER elsewhere.
; tools/windows/release.sh defines VERSION, TREE (the files), REMOVE (commands that remove them) and SETUP (the result).

Unicode true
Target amd64-unicode
ManifestDPIAware true
RequestExecutionLevel user
; The dictionary holds a whole program, so the second one of the same bytes takes no room.
SetCompressor /SOLID lzma
SetCompressorDictSize 64
SetDateSave on

!include MUI2.nsh
!include FileFunc.nsh

!define UNINSTALL "Software\Microsoft\Windows\CurrentVersion\Uninstall\encoder-studio"
!define PROFILE "encoder-studio.profile"
!define WINDOW "$INSTDIR\encoder-studio-window.exe"

Name "encoder-studio"
OutFile "${SETUP}"
BrandingText "encoder-studio ${VERSION}"
InstallDir "$LOCALAPPDATA\Programs\encoder-studio"
InstallDirRegKey HKCU "${UNINSTALL}" InstallLocation
!uninstfinalize 'tools/windows/sign.sh "%1" uninstall.exe'

!define MUI_ICON assets/icon/encoder-studio.ico
!define MUI_UNICON assets/icon/encoder-studio.ico
!define MUI_FINISHPAGE_RUN "${WINDOW}"
!insertmacro MUI_PAGE_DIRECTORY
!insertmacro MUI_PAGE_INSTFILES
!insertmacro MUI_PAGE_FINISH
!insertmacro MUI_UNPAGE_CONFIRM
!insertmacro MUI_UNPAGE_INSTFILES
!insertmacro MUI_LANGUAGE English
!insertmacro MUI_LANGUAGE German

LangString RUNNING ${LANG_ENGLISH} "encoder-studio is running. Close it, then try again."
LangString RUNNING ${LANG_GERMAN} "encoder-studio läuft. Das Programm schließen und es dann erneut versuchen."
LangString FORGET ${LANG_ENGLISH} "Remove the settings, drafts, backups and the logbook as well?"
LangString FORGET ${LANG_GERMAN} "Auch Einstellungen, Entwürfe, Sicherungen und das Logbuch entfernen?"
LangString OPEN ${LANG_ENGLISH} "Open with encoder-studio"
LangString OPEN ${LANG_GERMAN} "Mit encoder-studio öffnen"
LangString TYPE ${LANG_ENGLISH} "Encoder profile"
LangString TYPE ${LANG_GERMAN} "Geberprofil"
LangString CONSOLE ${LANG_ENGLISH} "encoder-studio command line"
LangString CONSOLE ${LANG_GERMAN} "encoder-studio Kommandozeile"

; Windows does not delete a program that is running. A silent installation ends with status 2 then.
!macro REMOVE_PROGRAMS
    ${Do}
        ClearErrors
        Delete "$INSTDIR\encoder-studio.exe"
        Delete "${WINDOW}"
        ${IfNot} ${Errors}
            ${ExitDo}
        ${EndIf}
        MessageBox MB_RETRYCANCEL|MB_ICONEXCLAMATION "$(RUNNING)" /SD IDCANCEL IDRETRY +3
            SetErrorLevel 2
            Abort "$(RUNNING)"
    ${Loop}
!macroend

Section
    SetShellVarContext current
    !insertmacro REMOVE_PROGRAMS
    SetOutPath $INSTDIR
    File /r "${TREE}/*"
    WriteUninstaller "$INSTDIR\uninstall.exe"

    CreateShortcut "$SMPROGRAMS\encoder-studio.lnk" "${WINDOW}"
    CreateShortcut "$SMPROGRAMS\$(CONSOLE).lnk" "$SYSDIR\cmd.exe" '/k "set PATH=$INSTDIR;%PATH%&&cd /d %USERPROFILE%"' \
        "$INSTDIR\encoder-studio.exe"
    WriteRegStr HKCU "${UNINSTALL}" Console "$(CONSOLE).lnk"

    ; Profiles are RON files, and so are files of other programs: these keep the program that opens them.
    WriteRegStr HKCU "Software\Classes\${PROFILE}" "" "$(TYPE)"
    WriteRegStr HKCU "Software\Classes\${PROFILE}\DefaultIcon" "" "${WINDOW},0"
    WriteRegStr HKCU "Software\Classes\${PROFILE}\shell\open" "" "$(OPEN)"
    WriteRegStr HKCU "Software\Classes\${PROFILE}\shell\open\command" "" '"${WINDOW}" --profile "%1"'
    WriteRegStr HKCU "Software\Classes\.ron\OpenWithProgids" "${PROFILE}" ""

    WriteRegStr HKCU "${UNINSTALL}" DisplayName "encoder-studio"
    WriteRegStr HKCU "${UNINSTALL}" DisplayVersion "${VERSION}"
    WriteRegStr HKCU "${UNINSTALL}" DisplayIcon "${WINDOW}"
    WriteRegStr HKCU "${UNINSTALL}" Publisher "The encoder-studio authors"
    WriteRegStr HKCU "${UNINSTALL}" InstallLocation "$INSTDIR"
    WriteRegStr HKCU "${UNINSTALL}" UninstallString '"$INSTDIR\uninstall.exe"'
    WriteRegStr HKCU "${UNINSTALL}" QuietUninstallString '"$INSTDIR\uninstall.exe" /S'
    WriteRegDWORD HKCU "${UNINSTALL}" NoModify 1
    WriteRegDWORD HKCU "${UNINSTALL}" NoRepair 1
    ${GetSize} "$INSTDIR" "/S=0K" $0 $1 $2
    WriteRegDWORD HKCU "${UNINSTALL}" EstimatedSize $0
    System::Call 'shell32::SHChangeNotify(i 0x08000000, i 0, p 0, p 0)'
SectionEnd

Section Uninstall
    SetShellVarContext current
    !insertmacro REMOVE_PROGRAMS
    !include "${REMOVE}"
    Delete "$INSTDIR\uninstall.exe"
    RMDir "$INSTDIR"
    Delete "$SMPROGRAMS\encoder-studio.lnk"
    ReadRegStr $0 HKCU "${UNINSTALL}" Console
    ${If} $0 != ""
        Delete "$SMPROGRAMS\$0"
    ${EndIf}
    DeleteRegKey HKCU "Software\Classes\${PROFILE}"
    DeleteRegValue HKCU "Software\Classes\.ron\OpenWithProgids" "${PROFILE}"
    DeleteRegKey /ifempty HKCU "Software\Classes\.ron\OpenWithProgids"
    DeleteRegKey /ifempty HKCU "Software\Classes\.ron"
    DeleteRegKey HKCU "${UNINSTALL}"
    ; The data of the user stay, unless removal is chosen.
    MessageBox MB_YESNO|MB_ICONQUESTION|MB_DEFBUTTON2 "$(FORGET)" /SD IDNO IDNO +3
        RMDir /r "$APPDATA\encoder-studio"
        RMDir /r "$LOCALAPPDATA\encoder-studio"
    System::Call 'shell32::SHChangeNotify(i 0x08000000, i 0, p 0, p 0)'
SectionEnd
